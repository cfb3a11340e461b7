// Ceres writes warnings about numbers that we look at ourselves.
#pragma once

namespace povslam {

void silence_ceres();  // for the whole process; once is enough, more do no harm; any thread

}  // namespace povslam

// Names the calling thread for top, gdb and perf; the kernel keeps 15 letters.
#pragma once

#include <pthread.h>

#include <string>

namespace povslam {

inline void name_this_thread(const std::string& name) {
  pthread_setname_np(pthread_self(), name.substr(0, 15).c_str());
}

}  // namespace povslam

#include "pipeline/backend/silence_ceres.hpp"

#include <glog/logging.h>

namespace povslam {

void silence_ceres() {
  static const bool silent = [] {
    FLAGS_minloglevel = google::GLOG_FATAL;
    return true;
  }();
  static_cast<void>(silent);
}

}  // namespace povslam

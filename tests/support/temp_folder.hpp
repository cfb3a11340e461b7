// A folder of its own for one test program, gone when the program ends: tests may run side by side.
#pragma once

#include <stdlib.h>

#include <filesystem>
#include <string>

#include "pipeline/base/expects.hpp"

namespace povslam {

class TempFolder {
 public:
  TempFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "povslam_test_XXXXXX").string();
    EXPECTS(mkdtemp(name.data()) != nullptr);
    path_ = name;
  }
  ~TempFolder() {
    std::error_code fault;
    std::filesystem::remove_all(path_, fault);
  }
  TempFolder(const TempFolder&) = delete;
  TempFolder& operator=(const TempFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

inline const std::filesystem::path& temp_folder() {
  static const TempFolder folder;
  return folder.path();
}

}  // namespace povslam

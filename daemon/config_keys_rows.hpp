// How rows of the table of keys are written; for config_keys*.cpp only.
#pragma once

#include <utility>

#include "daemon/config_keys.hpp"

// Getter of a member of the configuration.
#define AT(member)            \
  [](auto& config) -> auto& { \
    return config.member;     \
  }

// Getter of a member that is an enumeration of bytes.
#define AT_CHOICE(member) [](auto& config) -> std::uint8_t& { return reinterpret_cast<std::uint8_t&>(config.member); }

namespace povslam {

template <class Config>
struct Row {
  template <class Getter>
  static Member<Config> at(Getter getter) {
    using Value = decltype(getter(std::declval<Config&>()));
    return static_cast<Value (*)(Config&)>(getter);
  }
};

inline Key<AppConfig> key(const char* path, auto getter, double min, double max, const char* doc) {
  return {path, Row<AppConfig>::at(getter), doc, min, max};
}
inline Key<AppConfig> text(const char* path, auto getter, const char* doc, std::vector<std::string> choices = {}) {
  return {path, Row<AppConfig>::at(getter), doc, 0, 512, std::move(choices)};
}

std::vector<Key<AppConfig>> vem_table();            // config_keys_vem.cpp
std::vector<Key<AppConfig>> understanding_table();  // config_keys_understanding.cpp

}  // namespace povslam

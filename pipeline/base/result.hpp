// Result<T>: a value, or an Error whose message names the file, key or device and the remedy.
//   Result<Config> load(...);   if (!config) return config.error();   use(*config);
#pragma once

#include <string>
#include <utility>
#include <variant>

#include "pipeline/base/expects.hpp"

namespace povslam {

struct Error {
  std::string message;
};

struct Done {};  // the value of a Result that has nothing to say but "it worked"

template <class T>
class [[nodiscard]] Result {
 public:
  Result(T value) : state_(std::move(value)) {}      // NOLINT: implicit, so that `return value;` works
  Result(Error error) : state_(std::move(error)) {}  // NOLINT: implicit, so that `return Error{…};` works

  explicit operator bool() const { return std::holds_alternative<T>(state_); }

  T& operator*() { return value(); }
  const T& operator*() const { return value(); }
  T* operator->() { return &value(); }
  const T* operator->() const { return &value(); }

  T& value() {
    EXPECTS(*this);
    return std::get<T>(state_);
  }
  const T& value() const {
    EXPECTS(*this);
    return std::get<T>(state_);
  }
  const Error& error() const {
    EXPECTS(!*this);
    return std::get<Error>(state_);
  }

 private:
  std::variant<T, Error> state_;
};

using Status = Result<Done>;

}  // namespace povslam

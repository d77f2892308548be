// Declarations that a test compiles the controllers of `gelenk new --ros2` with: only what they use of rclcpp.
#pragma once

#include <cstdio>
#include <string>
#include <variant>
#include <vector>

namespace rclcpp
{
class Time {};
class Duration {};
class Logger {};

class Parameter
{
public:
  using Value = std::variant<std::vector<std::string>, std::vector<double>>;

  explicit Parameter(Value value) : value_(std::move(value)) {}
  template <typename T>
  T get_value() const { return std::get<T>(value_); }
  const std::vector<std::string> & as_string_array() const { return std::get<0>(value_); }
  const std::vector<double> & as_double_array() const { return std::get<1>(value_); }

private:
  Value value_;
};
}  // namespace rclcpp

#define RCLCPP_ERROR(logger, ...) (static_cast<void>(logger), std::printf(__VA_ARGS__), std::putchar('\n'))

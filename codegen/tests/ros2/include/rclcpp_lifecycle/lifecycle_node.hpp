// The node of a controller, with parameters as a launch file sets them.
#pragma once

#include <map>
#include <string>

#include "rclcpp/rclcpp.hpp"
#include "rclcpp_lifecycle/state.hpp"

namespace rclcpp_lifecycle
{
class LifecycleNode
{
public:
  using Overrides = std::map<std::string, rclcpp::Parameter::Value>;

  LifecycleNode(const std::string & name, const Overrides & overrides) : name_(name), overrides_(overrides) {}
  const char * get_name() const { return name_.c_str(); }
  rclcpp::Logger get_logger() const { return {}; }
  bool has_parameter(const std::string & name) const { return declared_.count(name) == 1; }
  rclcpp::Parameter get_parameter(const std::string & name) const
  {
    return rclcpp::Parameter(declared_.at(name));
  }
  template <typename T>
  T declare_parameter(const std::string & name, const T & otherwise)
  {
    const auto set = overrides_.find(name);
    declared_[name] = set == overrides_.end() ? rclcpp::Parameter::Value(otherwise) : set->second;
    return get_parameter(name).get_value<T>();
  }

private:
  std::string name_;
  Overrides overrides_, declared_;
};

namespace node_interfaces
{
class LifecycleNodeInterface
{
public:
  enum class CallbackReturn { SUCCESS, FAILURE, ERROR };

  virtual ~LifecycleNodeInterface() = default;
  virtual CallbackReturn on_configure(const State &) { return CallbackReturn::SUCCESS; }
  virtual CallbackReturn on_activate(const State &) { return CallbackReturn::SUCCESS; }
  virtual CallbackReturn on_deactivate(const State &) { return CallbackReturn::SUCCESS; }
};
}  // namespace node_interfaces
}  // namespace rclcpp_lifecycle

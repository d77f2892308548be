// States and effort commands of the joints of robot.toml, which both controllers use.

#ifndef MY_PACKAGE__JOINTS_HPP_
#define MY_PACKAGE__JOINTS_HPP_

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <exception>
#include <limits>
#include <string>
#include <type_traits>
#include <vector>

#include "controller_interface/controller_interface_base.hpp"
#include "hardware_interface/types/hardware_interface_type_values.hpp"
#include "rclcpp/rclcpp.hpp"
#include "rclcpp_lifecycle/state.hpp"

#include "robot.h"

#ifdef ROBOT_NY
#error "ros2_control has no interfaces for joints with quaternions"
#endif
static_assert(
  std::is_invocable_v<decltype(&robot_gravity_forces), const double *, double *>,
  "robot.toml has free parameters or driven joints, for which the controllers have no values");

namespace my_package
{

using controller_interface::CallbackReturn;
using controller_interface::return_type;
using Vector = std::array<double, ROBOT_N>;

/// A controller that reads positions and velocities of all joints of robot.toml and commands their efforts.
///
/// `update` neither allocates nor locks. `on_configure` and `on_activate` find the interfaces by name.
template <class Base>
class Joints : public Base
{
public:
  CallbackReturn on_init() override
  {
    try {
      declare();
    } catch (const std::exception & error) {
      return fail(error.what());
    }
    return CallbackReturn::SUCCESS;
  }

  /// Compares the parameter `joints` with the joints of robot.toml.
  CallbackReturn on_configure(const rclcpp_lifecycle::State &) override
  {
    names_ = this->get_node()->get_parameter("joints").as_string_array();
    for (const std::string & name : names_) {
      if (std::find(std::begin(ROBOT_JOINT_NAMES), std::end(ROBOT_JOINT_NAMES), name) ==
        std::end(ROBOT_JOINT_NAMES))
      {
        return fail("parameter 'joints': robot.toml has no joint '" + name + "'");
      }
    }
    for (std::size_t i = 0; i < ROBOT_N; ++i) {
      const auto count = std::count(names_.begin(), names_.end(), ROBOT_JOINT_NAMES[i]);
      if (count != 1) {
        return fail(
          std::string("parameter 'joints' ") + (count == 0 ? "lacks" : "contains more than once") +
          " the joint '" + ROBOT_JOINT_NAMES[i] + "' of robot.toml");
      }
      place_[i] = std::find(names_.begin(), names_.end(), ROBOT_JOINT_NAMES[i]) - names_.begin();
    }
    return CallbackReturn::SUCCESS;
  }

  controller_interface::InterfaceConfiguration command_interface_configuration() const override
  {
    return interfaces({hardware_interface::HW_IF_EFFORT});
  }

  controller_interface::InterfaceConfiguration state_interface_configuration() const override
  {
    return interfaces({hardware_interface::HW_IF_POSITION, hardware_interface::HW_IF_VELOCITY});
  }

  CallbackReturn on_activate(const rclcpp_lifecycle::State &) override
  {
    if (!find(this->command_interfaces_, hardware_interface::HW_IF_EFFORT, efforts_) ||
      !find(this->state_interfaces_, hardware_interface::HW_IF_POSITION, positions_) ||
      !find(this->state_interfaces_, hardware_interface::HW_IF_VELOCITY, velocities_))
    {
      return CallbackReturn::ERROR;
    }
    y_.fill(std::numeric_limits<double>::quiet_NaN());
    v_ = y_;
    return read() ? CallbackReturn::SUCCESS : fail("a position or a velocity is not a finite number");
  }

  CallbackReturn on_deactivate(const rclcpp_lifecycle::State &) override
  {
    return write(Vector{}) ? CallbackReturn::SUCCESS : fail("an effort cannot be set to 0");
  }

protected:
  virtual void declare()
  {
    this->template auto_declare<std::vector<std::string>>("joints", {});
  }

  CallbackReturn fail(const std::string & message) const
  {
    RCLCPP_ERROR(this->get_node()->get_logger(), "%s", message.c_str());
    return CallbackReturn::ERROR;
  }

  /// Reads the state. If another thread holds a value, the value of the previous period is kept.
  ///
  /// Returns whether all values are finite.
  bool read()
  {
    bool is_finite = true;
    for (std::size_t i = 0; i < ROBOT_N; ++i) {
      y_[i] = this->state_interfaces_[positions_[i]].get_optional().value_or(y_[i]);
      v_[i] = this->state_interfaces_[velocities_[i]].get_optional().value_or(v_[i]);
      is_finite = is_finite && std::isfinite(y_[i]) && std::isfinite(v_[i]);
    }
    return is_finite;
  }

  /// Commands efforts in N m or N, clamped to the limits of robot.toml. If an effort is not finite, none is commanded and the
  /// result is an error. If another thread holds a command, the command of the previous period is kept.
  return_type command(const Vector & efforts)
  {
    for (const double effort : efforts) {
      if (!std::isfinite(effort)) {
        return return_type::ERROR;
      }
    }
    write(efforts);
    return return_type::OK;
  }

  /// Writes efforts, clamped to the limits. Returns whether all efforts were written.
  bool write(const Vector & efforts)
  {
    bool is_written = true;
    for (std::size_t i = 0; i < ROBOT_N; ++i) {
      const double limit = ROBOT_PEAK_EFFORT_LIMITS[i];
      const double effort = std::clamp(efforts[i], -limit, limit);
      is_written = this->command_interfaces_[efforts_[i]].set_value(effort) && is_written;
    }
    return is_written;
  }

  /// Positions in rad or m, and velocities in rad/s or m/s, in the order of robot.toml.
  Vector y_{}, v_{};
  /// Index of each joint of robot.toml in the parameter `joints`.
  std::array<std::size_t, ROBOT_N> place_{};

private:
  using Places = std::array<std::size_t, ROBOT_N>;

  controller_interface::InterfaceConfiguration interfaces(const std::vector<std::string> & kinds) const
  {
    controller_interface::InterfaceConfiguration configuration{
      controller_interface::interface_configuration_type::INDIVIDUAL, {}};
    for (const std::string & name : names_) {
      for (const std::string & kind : kinds) {
        configuration.names.push_back(name + "/" + kind);
      }
    }
    return configuration;
  }

  /// Finds the interface of each joint of robot.toml by its name.
  template <class Loaned>
  bool find(const std::vector<Loaned> & loaned, const std::string & kind, Places & places) const
  {
    for (std::size_t i = 0; i < ROBOT_N; ++i) {
      const std::string name = std::string(ROBOT_JOINT_NAMES[i]) + "/" + kind;
      const auto found = std::find_if(
        loaned.begin(), loaned.end(), [&](const Loaned & one) {return one.get_name() == name;});
      if (found == loaned.end()) {
        fail("the hardware has no interface '" + name + "'");
        return false;
      }
      places[i] = found - loaned.begin();
    }
    return true;
  }

  std::vector<std::string> names_;
  Places efforts_{}, positions_{}, velocities_{};
};

}  // namespace my_package

#endif  // MY_PACKAGE__JOINTS_HPP_

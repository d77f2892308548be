// Controller that tracks the references of another controller with the inverse dynamics at the measured state.

#include "controller_interface/chainable_controller_interface.hpp"
#include "pluginlib/class_list_macros.hpp"

#include "joints.hpp"

namespace my_package
{

/// Computed-torque control (Siciliano et al., Robotics, 2009, section 8.5.2):
///
///     τ = M(y) (ÿ_d + K_d (ẏ_d − ẏ) + K_p (y_d − y)) + k(y, ẏ) − q(y, ẏ)
///
/// The reference interfaces are positions, velocities and accelerations of all joints, in the order of robot.toml. The robot
/// holds its posture until another controller sets the references.
class ComputedTorque : public Joints<controller_interface::ChainableControllerInterface>
{
public:
  CallbackReturn on_configure(const rclcpp_lifecycle::State & state) override
  {
    const CallbackReturn configured = Joints::on_configure(state);
    const bool has_joints = configured == CallbackReturn::SUCCESS;
    if (has_joints && !(take("position_gains", position_gains_) && take("velocity_gains", velocity_gains_))) {
      return CallbackReturn::ERROR;
    }
    return configured;
  }

  CallbackReturn on_activate(const rclcpp_lifecycle::State & state) override
  {
    const CallbackReturn activated = Joints::on_activate(state);
    if (activated == CallbackReturn::SUCCESS) {
      std::fill(reference_interfaces_.begin(), reference_interfaces_.end(), 0.0);
      std::copy(y_.begin(), y_.end(), reference_interfaces_.begin());
      held_ = y_;
    }
    return activated;
  }

protected:
  void declare() override
  {
    Joints::declare();
    auto_declare<std::vector<double>>("position_gains", {});
    auto_declare<std::vector<double>>("velocity_gains", {});
  }

  std::vector<hardware_interface::CommandInterface> on_export_reference_interfaces() override
  {
    reference_interfaces_.assign(KINDS.size() * ROBOT_N, std::numeric_limits<double>::quiet_NaN());
    std::vector<hardware_interface::CommandInterface> interfaces;
    for (std::size_t kind = 0; kind < KINDS.size(); ++kind) {
      for (std::size_t i = 0; i < ROBOT_N; ++i) {
        const std::string prefix = std::string(get_node()->get_name()) + "/" + ROBOT_JOINT_NAMES[i];
        interfaces.emplace_back(prefix, KINDS[kind], &reference_interfaces_[kind * ROBOT_N + i]);
      }
    }
    return interfaces;
  }

  /// Stops the robot at the last reference if no other controller sets references.
  return_type update_reference_from_subscribers(const rclcpp::Time &, const rclcpp::Duration &) override
  {
    std::fill(reference_interfaces_.begin() + ROBOT_N, reference_interfaces_.end(), 0.0);
    return return_type::OK;
  }

  return_type update_and_write_commands(const rclcpp::Time &, const rclcpp::Duration &) override
  {
    if (!read()) {
      return return_type::ERROR;
    }
    Vector a, efforts;
    for (std::size_t i = 0; i < ROBOT_N; ++i) {
      held_[i] = finite(reference_interfaces_[i], held_[i]);
      a[i] = finite(reference_interfaces_[2 * ROBOT_N + i], 0.0) +
        velocity_gains_[i] * (finite(reference_interfaces_[ROBOT_N + i], 0.0) - v_[i]) +
        position_gains_[i] * (held_[i] - y_[i]);
    }
    robot_inverse_dynamics(y_.data(), v_.data(), a.data(), efforts.data());
    return command(efforts);
  }

private:
  static constexpr std::array<const char *, 3> KINDS{
    hardware_interface::HW_IF_POSITION, hardware_interface::HW_IF_VELOCITY,
    hardware_interface::HW_IF_ACCELERATION};

  static double finite(double value, double otherwise)
  {
    return std::isfinite(value) ? value : otherwise;
  }

  /// Reads gains from a parameter, in the order of the parameter `joints`. Returns whether all gains are valid.
  bool take(const std::string & parameter, Vector & gains) const
  {
    const std::vector<double> values = get_node()->get_parameter(parameter).as_double_array();
    const auto is_gain = [](double gain) {return std::isfinite(gain) && gain >= 0.0;};
    if (values.size() != ROBOT_N || !std::all_of(values.begin(), values.end(), is_gain)) {
      fail("parameter '" + parameter + "' needs one non-negative number for each entry of 'joints'");
      return false;
    }
    for (std::size_t i = 0; i < ROBOT_N; ++i) {
      gains[i] = values[place_[i]];
    }
    return true;
  }

  Vector position_gains_{}, velocity_gains_{}, held_{};
};

}  // namespace my_package

PLUGINLIB_EXPORT_CLASS(my_package::ComputedTorque, controller_interface::ChainableControllerInterface)

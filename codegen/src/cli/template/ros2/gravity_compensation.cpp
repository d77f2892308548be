// Controller that compensates gravity, so that the robot can be moved by hand.

#include "controller_interface/controller_interface.hpp"
#include "pluginlib/class_list_macros.hpp"

#include "joints.hpp"

namespace my_package
{

/// Commands the gravity torques at the measured positions.
class GravityCompensation : public Joints<controller_interface::ControllerInterface>
{
public:
  return_type update(const rclcpp::Time &, const rclcpp::Duration &) override
  {
    if (!read()) {
      return return_type::ERROR;
    }
    Vector efforts;
    robot_gravity_forces(y_.data(), efforts.data());
    for (double & effort : efforts) {
      effort = -effort;
    }
    return command(efforts);
  }
};

}  // namespace my_package

PLUGINLIB_EXPORT_CLASS(my_package::GravityCompensation, controller_interface::ControllerInterface)

#pragma once

#include <vector>

#include "controller_interface/controller_interface_base.hpp"

namespace controller_interface
{
class ChainableControllerInterface : public ControllerInterfaceBase
{
public:
  return_type update(const rclcpp::Time & time, const rclcpp::Duration & period) final
  {
    const return_type read =
      is_chained ? return_type::OK : update_reference_from_subscribers(time, period);
    return read == return_type::OK ? update_and_write_commands(time, period) : read;
  }
  std::vector<hardware_interface::CommandInterface> export_references() final
  {
    return on_export_reference_interfaces();
  }

protected:
  virtual std::vector<hardware_interface::CommandInterface> on_export_reference_interfaces() = 0;
  virtual return_type update_reference_from_subscribers(
    const rclcpp::Time & time, const rclcpp::Duration & period) = 0;
  virtual return_type update_and_write_commands(
    const rclcpp::Time & time, const rclcpp::Duration & period) = 0;

  std::vector<double> reference_interfaces_;
};
}  // namespace controller_interface

// Registers a class under its name, so that a test can make one as pluginlib does.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>

#include "controller_interface/controller_interface_base.hpp"

using Controller = controller_interface::ControllerInterfaceBase;

inline std::map<std::string, std::function<std::unique_ptr<Controller>()>> & plugins()
{
  static std::map<std::string, std::function<std::unique_ptr<Controller>()>> made;
  return made;
}

#define PLUGINLIB_EXPORT_CLASS(type, base) \
  static const bool is_registered = [] { \
    plugins()[#type] = [] { std::unique_ptr<base> one = std::make_unique<type>(); return one; }; \
    return true; \
  }();

// Interfaces of joints. A loaned one reads and writes through a pointer; without a pointer another thread holds it.
#pragma once

#include <optional>
#include <string>

namespace hardware_interface
{
class Handle
{
public:
  Handle(const std::string & prefix, const std::string & kind, double * value)
  : name_(prefix + "/" + kind), value_(value) {}
  const std::string & get_name() const { return name_; }
  template <typename T = double>
  [[nodiscard]] std::optional<T> get_optional() const
  {
    return value_ ? std::optional<T>(*value_) : std::nullopt;
  }
  template <typename T>
  [[nodiscard]] bool set_value(const T & value) { return value_ && (*value_ = value, true); }

private:
  std::string name_;
  double * value_;
};

class StateInterface : public Handle
{
public:
  using Handle::Handle;
};

class CommandInterface : public Handle
{
public:
  using Handle::Handle;
  CommandInterface(const CommandInterface &) = delete;
  CommandInterface(CommandInterface &&) = default;
};

class LoanedStateInterface
{
public:
  explicit LoanedStateInterface(StateInterface & one) : one_(one) {}
  LoanedStateInterface(const LoanedStateInterface &) = delete;
  LoanedStateInterface(LoanedStateInterface &&) = default;
  const std::string & get_name() const { return one_.get_name(); }
  template <typename T = double>
  [[nodiscard]] std::optional<T> get_optional(unsigned int = 10) const { return one_.get_optional<T>(); }

private:
  const StateInterface & one_;
};

class LoanedCommandInterface
{
public:
  explicit LoanedCommandInterface(CommandInterface & one) : one_(one) {}
  LoanedCommandInterface(const LoanedCommandInterface &) = delete;
  LoanedCommandInterface(LoanedCommandInterface &&) = default;
  const std::string & get_name() const { return one_.get_name(); }
  template <typename T>
  [[nodiscard]] bool set_value(const T & value, unsigned int = 10) { return one_.set_value(value); }

private:
  CommandInterface & one_;
};
}  // namespace hardware_interface

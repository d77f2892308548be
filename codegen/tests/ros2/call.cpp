// Runs the controllers of a package as ros2_control does, and compares their efforts with the module in C.

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <new>
#include <string>
#include <vector>

#include "controller_interface/controller_interface_base.hpp"
#include "pluginlib/class_list_macros.hpp"

#include "robot.h"

static int allocations = 0;

// Not inlined, since g++ then warns of `free`.
__attribute__((noinline)) void * operator new(std::size_t size)
{
  ++allocations;
  if (void * memory = std::malloc(size)) {return memory;}
  throw std::bad_alloc();
}
__attribute__((noinline)) void operator delete(void * memory) noexcept { std::free(memory); }
__attribute__((noinline)) void operator delete(void * memory, std::size_t) noexcept { std::free(memory); }

#define REQUIRE(is_true) \
  do { if (!(is_true)) {std::printf("line %d: %s\n", __LINE__, #is_true); std::exit(1);} } while (false)

using controller_interface::CallbackReturn;
using controller_interface::return_type;
using Overrides = rclcpp_lifecycle::LifecycleNode::Overrides;
using Strings = std::vector<std::string>;
using Numbers = std::vector<double>;
using Vector = std::array<double, ROBOT_N>;

constexpr double NONE = std::numeric_limits<double>::quiet_NaN();

/// A robot whose joints are in the reverse order.
struct Hardware
{
  Vector y{}, v{}, efforts{};
  std::vector<hardware_interface::StateInterface> states;
  std::vector<hardware_interface::CommandInterface> commands;

  Hardware()
  {
    for (std::size_t i = ROBOT_N; i-- > 0; ) {
      states.emplace_back(ROBOT_JOINT_NAMES[i], "velocity", &v[i]);
      states.emplace_back(ROBOT_JOINT_NAMES[i], "position", &y[i]);
      commands.emplace_back(ROBOT_JOINT_NAMES[i], "effort", &efforts[i]);
      y[i] = 0.3 - 0.2 * i;
      v[i] = 0.1 + 0.4 * i;
    }
  }

  void lend(Controller & to)
  {
    std::vector<hardware_interface::LoanedStateInterface> state;
    std::vector<hardware_interface::LoanedCommandInterface> command;
    for (auto & one : states) {state.emplace_back(one);}
    for (auto & one : commands) {command.emplace_back(one);}
    to.assign_interfaces(std::move(command), std::move(state));
  }
};

static Strings reversed()
{
  return Strings(std::rbegin(ROBOT_JOINT_NAMES), std::rend(ROBOT_JOINT_NAMES));
}

static CallbackReturn configured(const std::string & plugin, const Overrides & parameters)
{
  const auto one = plugins().at(plugin)();
  REQUIRE(one->init("one", parameters) == CallbackReturn::SUCCESS);
  return one->on_configure({});
}

static return_type updated(Controller & one)
{
  const int before = allocations;
  const return_type result = one.update({}, {});
  REQUIRE(allocations == before);
  return result;
}

static void gravity(const std::string & plugin)
{
  const Strings joints = reversed();
  Strings less(joints.begin() + 1, joints.end()), twice = joints, foreign = joints;
  twice.push_back(joints[0]);
  foreign.push_back("elsewhere");
  for (const Strings & wrong : {less, twice, foreign, Strings{}}) {
    REQUIRE(configured(plugin, {{"joints", wrong}}) == CallbackReturn::ERROR);
  }
  const auto one = plugins().at(plugin)();
  REQUIRE(one->init("gravity", {{"joints", joints}}) == CallbackReturn::SUCCESS);
  REQUIRE(one->on_configure({}) == CallbackReturn::SUCCESS);
  REQUIRE(one->command_interface_configuration().names.front() == joints[0] + "/effort");
  REQUIRE(one->state_interface_configuration().names.size() == 2 * ROBOT_N);

  REQUIRE(one->on_activate({}) == CallbackReturn::ERROR); // no interface is lent
  Hardware robot;
  robot.lend(*one);
  robot.y[0] = NONE;
  REQUIRE(one->on_activate({}) == CallbackReturn::ERROR);
  robot.y[0] = 0.7;
  REQUIRE(one->on_activate({}) == CallbackReturn::SUCCESS);
  REQUIRE(updated(*one) == return_type::OK);
  Vector weight;
  robot_gravity_forces(robot.y.data(), weight.data());
  for (std::size_t i = 0; i < ROBOT_N; ++i) {
    REQUIRE(robot.efforts[i] == -weight[i]);
    std::printf("%s %.17g %.17g\n", ROBOT_JOINT_NAMES[i], robot.y[i], robot.efforts[i]);
  }
  robot.v[0] = NONE;
  REQUIRE(updated(*one) == return_type::ERROR);
  REQUIRE(one->on_deactivate({}) == CallbackReturn::SUCCESS);
  REQUIRE(robot.efforts == Vector{});
}

static void computed_torque(const std::string & plugin)
{
  const Strings joints = reversed();
  Numbers stiff, damped;
  for (std::size_t i = 0; i < ROBOT_N; ++i) {
    stiff.push_back(10.0 + i);
    damped.push_back(2.0 + i);
  }
  const Numbers few(ROBOT_N - 1, 1.0), negative(ROBOT_N, -1.0), none(ROBOT_N, NONE);
  for (const Numbers & wrong : {few, negative, none}) {
    const Overrides parameters{{"joints", joints}, {"position_gains", stiff}, {"velocity_gains", wrong}};
    REQUIRE(configured(plugin, parameters) == CallbackReturn::ERROR);
  }
  const auto one = plugins().at(plugin)();
  const Overrides parameters{{"joints", joints}, {"position_gains", stiff}, {"velocity_gains", damped}};
  REQUIRE(one->init("torque", parameters) == CallbackReturn::SUCCESS);
  REQUIRE(one->on_configure({}) == CallbackReturn::SUCCESS);
  auto references = one->export_references();
  REQUIRE(references.size() == 3 * ROBOT_N);
  REQUIRE(references[ROBOT_N].get_name() == std::string("torque/") + ROBOT_JOINT_NAMES[0] + "/velocity");
  Hardware robot;
  robot.lend(*one);
  REQUIRE(one->on_activate({}) == CallbackReturn::SUCCESS);

  const auto expected = [&](const Vector & y, const Vector & v, const Vector & a) {
      Vector commanded, efforts;
      for (std::size_t i = 0; i < ROBOT_N; ++i) {
        const std::size_t named = ROBOT_N - 1 - i;
        commanded[i] = a[i] + damped[named] * (v[i] - robot.v[i]) + stiff[named] * (y[i] - robot.y[i]);
      }
      robot_inverse_dynamics(robot.y.data(), robot.v.data(), commanded.data(), efforts.data());
      for (std::size_t i = 0; i < ROBOT_N; ++i) {
        efforts[i] = std::fmin(std::fmax(efforts[i], -ROBOT_PEAK_EFFORT_LIMITS[i]), ROBOT_PEAK_EFFORT_LIMITS[i]);
      }
      return efforts;
    };
  // Without references the posture of the activation is held.
  const Vector posture = robot.y;
  robot.y[1] += 0.05;
  REQUIRE(updated(*one) == return_type::OK);
  REQUIRE(robot.efforts == expected(posture, {}, {}));

  one->is_chained = true;
  Vector y, v, a;
  for (std::size_t i = 0; i < ROBOT_N; ++i) {
    y[i] = 0.2 + 0.1 * i, v[i] = 0.3 - 0.2 * i, a[i] = 1.0 - 0.5 * i;
    REQUIRE(references[i].set_value(y[i]));
    REQUIRE(references[ROBOT_N + i].set_value(v[i]));
    REQUIRE(references[2 * ROBOT_N + i].set_value(a[i]));
  }
  REQUIRE(updated(*one) == return_type::OK);
  REQUIRE(robot.efforts == expected(y, v, a));
  for (double effort : robot.efforts) {std::printf("%.17g\n", effort);}

  // After the controller in front is stopped, the robot stops at its last position.
  one->is_chained = false;
  REQUIRE(updated(*one) == return_type::OK);
  REQUIRE(robot.efforts == expected(y, {}, {}));
  one->is_chained = true;

  // References that are no numbers hold the last position.
  for (auto & reference : references) {REQUIRE(reference.set_value(NONE));}
  REQUIRE(updated(*one) == return_type::OK);
  REQUIRE(robot.efforts == expected(y, {}, {}));
  // Efforts stay within their limits.
  REQUIRE(references[0].set_value(1e6));
  REQUIRE(updated(*one) == return_type::OK);
  REQUIRE(std::fabs(robot.efforts[0]) == ROBOT_PEAK_EFFORT_LIMITS[0]);
}

int main(int, char ** names)
{
  gravity(names[1]);
  computed_torque(names[2]);
  return 0;
}

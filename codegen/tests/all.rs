//! The tests of this package, as one program: it is linked once, and its tests share the processors. Those with Symbolica are a program of
//! their own.

mod bad;
mod bands;
mod c_command_line;
mod c_module;
#[path = "c_pages/main.rs"]
mod c_pages;
mod check;
#[path = "command_line/main.rs"]
mod command_line;
mod common;
#[path = "coupled_identification/main.rs"]
mod coupled_identification;
mod couplings;
mod cylinder_identification;
mod dependent_limits;
mod display;
mod doubts;
mod drawn_forces;
mod driven_joints;
mod elementary_functions;
mod emitted_code;
mod expanded;
#[path = "external_arm/main.rs"]
mod external_arm;
#[path = "findings/main.rs"]
mod findings;
#[path = "floating_identification/main.rs"]
mod floating_identification;
mod foreign;
mod held_grippers;
mod identified_friction;
mod kernel_texts;
mod kinds;
mod manifold;
mod meaning;
mod models;
mod motion_limits;
mod one_direction;
mod reference;
#[path = "ros2/main.rs"]
mod ros2;
mod scenes;
mod self_test;
mod shown_forces;
mod stages;
mod torque_speed;
mod wild_urdf;
mod words;

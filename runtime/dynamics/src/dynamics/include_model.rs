//! The macro that includes a module which a build script generated.

/// Includes a module that the build script generated: `include_model!(pub mod arm)` reads `$OUT_DIR/arm.rs`,
/// which is named after the robot (in a URDF: `<robot name="arm">`), not after the file. Where the build
/// script generates no robot of that name, the compiler's message says which it does. The documentation of
/// the module is the robot's description.
///
/// ```ignore
/// // Needs a build script: gelenk_codegen::build("arm.toml");
/// gelenk_dynamics::include_model!(
///     /// The arm on the bench.
///     pub mod arm
/// );
/// gelenk_dynamics::dynamics!(pub struct Arm = arm);
/// ```
#[macro_export]
macro_rules! include_model {
    ($(#[$meta:meta])* $visibility:vis mod $name:ident $(;)?) => {
        $(#[$meta])*
        // For rustdoc alone: where the module is missing, one error says so. A paragraph of its own.
        #[cfg_attr(doc, doc = "")]
        #[cfg_attr(doc, doc = include_str!(concat!(env!("OUT_DIR"), "/gelenk.", stringify!($name), ".md")))]
        #[allow(dead_code, reason = "a program need not call all functions of its robot")]
        $visibility mod $name {
            include!(concat!(
                env!(
                    "OUT_DIR",
                    "include_model! needs a build script, build.rs next to Cargo.toml, that calls `gelenk_codegen::build`"
                ),
                "/gelenk.modules.rs"
            ));
            gelenk_module!($name);
        }
    };
}

# A short menu; the logic lies in the program and in .ci/run.

# All checks of CI.
check:
    .ci/run

test:
    cargo test --workspace

# Review changed snapshots.
review:
    cargo insta review

# Everything in models/ to generated/src.
generate:
    cargo run --release -- generate

# Is generated/ fresh?
fresh:
    cargo run --release -- check

doc:
    cargo doc --workspace --no-deps --open

//! The command `octogrid`.
fn main() {}

//! `translume`.

fn main() -> std::process::ExitCode {
    translume_demo::main()
}

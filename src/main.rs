//! The command `hardpoint`.

fn main() -> std::process::ExitCode {
    hardpoint::cli::run()
}

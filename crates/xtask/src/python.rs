//! Virtual environments of the Python checks and of the book, and the package `lennard` in the first.

use std::error::Error;
use std::fs;
use std::path::PathBuf;
use std::process::Command;

use crate::workspace::{Workspace, cargo};

/// Prints the version of a Python that is new enough, and fails under an older one.
const VERSION: &str =
    "import sys; print('%d.%d' % sys.version_info[:2]); sys.exit(sys.version_info < (3, 11))";
/// Inside the environment: what it was made from, so that it is made anew when that changes.
const STAMP: &str = "made-from.txt";

/// A virtual environment.
pub struct Environment {
    /// Its folder.
    pub folder: PathBuf,
    /// The file that pins what is in it, in the repository.
    pub requirements: &'static str,
}

impl Environment {
    /// The environment of the validation.
    pub fn validation(workspace: &Workspace) -> Self {
        Self { folder: workspace.root.join(".venv"), requirements: "validation/requirements.txt" }
    }

    /// A program in it, such as `python`.
    pub fn program(&self, name: &str) -> PathBuf {
        let programs = if cfg!(windows) { "Scripts" } else { "bin" };
        let file = format!("{name}{}", std::env::consts::EXE_SUFFIX);
        self.folder.join(programs).join(file)
    }

    /// Makes it from the pinned requirements, or leaves it as it is where nothing changed.
    pub fn prepare(&self, workspace: &Workspace) -> Result<(), Box<dyn Error>> {
        let asked = workspace.command("python3").args(["-c", VERSION]).output();
        let version = asked.ok().filter(|output| output.status.success());
        let version = version.ok_or("Python 3.11 or newer is needed, as `python3`")?.stdout;
        let pinned = self.requirements;
        let requirements = fs::read_to_string(workspace.root.join(pinned))
            .map_err(|e| format!("{pinned}: {e}"))?;
        let made_from = format!("Python {}{requirements}", String::from_utf8(version)?);
        let stamp = self.folder.join(STAMP);
        let python = self.program("python");
        if python.exists() && fs::read_to_string(&stamp).is_ok_and(|s| s == made_from) {
            return Ok(());
        }
        println!("making {} from {pinned}", self.folder.display());
        let mut venv = workspace.command("python3");
        succeed(venv.args(["-m", "venv", "--clear"]).arg(&self.folder))
            .map_err(|e| format!("{e} (on Debian and Ubuntu: apt install python3-venv)"))?;
        let pip = |arguments: &[&str]| {
            let mut pip = workspace.command(&python);
            pip.args(["-m", "pip", "--disable-pip-version-check", "--quiet"]).args(arguments);
            succeed(&mut pip)
        };
        // Nothing but what the file pins; `check` then tells if a pin is missing.
        pip(&["install", "--no-deps", "--requirement", pinned])?;
        pip(&["check"])?;
        fs::write(&stamp, made_from)?;
        Ok(())
    }
}

/// Runs a command and wants success.
fn succeed(command: &mut Command) -> Result<(), String> {
    match command.status() {
        Ok(status) if status.success() => Ok(()),
        _ => Err(format!("{command:?} failed")),
    }
}

/// Makes the environment of the validation.
pub fn prepare(workspace: &Workspace) -> Result<(), Box<dyn Error>> {
    Environment::validation(workspace).prepare(workspace)
}

/// Builds the wheel of the package and installs it into `.venv`, as a user would install one.
///
/// The profile is the one of the tests: nothing but the extension itself is compiled for it.
pub fn install_package(workspace: &Workspace) -> Result<(), Box<dyn Error>> {
    let python = Environment::validation(workspace).program("python");
    let folder = workspace.target.join("wheels");
    if folder.exists() {
        fs::remove_dir_all(&folder)?;
    }
    let mut build = workspace.command(&python);
    build.args(["-m", "maturin", "build", "--quiet", "--profile", "dev", "--out"]).arg(&folder);
    succeed(build.env("CARGO", cargo()))?;
    let wheels = fs::read_dir(&folder)?.collect::<Result<Vec<_>, _>>()?;
    let [wheel] = wheels.as_slice() else {
        return Err(format!("maturin made {} wheels, wanted 1", wheels.len()).into());
    };
    let mut install = workspace.command(&python);
    install.args(["-m", "pip", "--disable-pip-version-check", "--quiet", "install"]);
    install.args(["--no-deps", "--no-index", "--force-reinstall"]).arg(wheel.path());
    Ok(succeed(&mut install)?)
}

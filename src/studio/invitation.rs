//! File that leads a browser to the page.
//!
//! Every user of a machine can read the arguments of its programs. So the address with its token must not be an argument. Instead
//! the browser gets the path of a file that only its owner can read. This file leads to the address.

use std::fs::OpenOptions;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// File that leads a browser to the address of the page. It is deleted when this value is dropped.
pub struct Invitation {
    _folder: TempDir,
    path: PathBuf,
}

impl Invitation {
    /// Writes a file that leads to an address, in a new folder that only its owner can open.
    ///
    /// # Errors
    /// If the folder or the file cannot be written.
    pub fn to(address: &str) -> io::Result<Self> {
        let mut builder = tempfile::Builder::new();
        builder.prefix("hardpoint-studio-");
        #[cfg(unix)]
        let permissions = std::os::unix::fs::PermissionsExt::from_mode(0o700);
        #[cfg(unix)]
        builder.permissions(permissions);
        let folder = builder.tempdir()?;
        let path = folder.path().join("open.html");
        let mut options = OpenOptions::new();
        options.write(true).create_new(true);
        #[cfg(unix)]
        std::os::unix::fs::OpenOptionsExt::mode(&mut options, 0o600);
        let page = include_str!("page/open.html").replace("{address}", address);
        options.open(&path)?.write_all(page.as_bytes())?;
        Ok(Invitation {
            _folder: folder,
            path,
        })
    }

    /// Path of the file that leads to the address.
    pub fn path(&self) -> &Path {
        &self.path
    }
}

//! Output that is whole or not there: files by renaming, standard output without broken pipes.

use std::fs::{self, File};
use std::io::{self, BufWriter, ErrorKind, Write};
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;

use crate::failure::Failure;

/// A file to be written.
#[derive(Debug)]
pub(crate) struct Output {
    path: PathBuf,
    /// Pipes and devices are written in place: renaming would replace them.
    in_place: bool,
}

impl Output {
    /// Makes sure before the long work that the file can be written; leaves nothing behind.
    ///
    /// # Errors
    /// Where the folder is missing or can't be written, or the path is a folder.
    pub(crate) fn at(path: &Path) -> Result<Self, Failure> {
        let in_place = match fs::metadata(path) {
            Ok(data) if data.is_dir() => return Err(Failure::at(path, "is a directory")),
            Ok(data) => !data.is_file(),
            Err(_) => false,
        };
        if path.file_name().is_none() {
            return Err(Failure::at(path, "is not the name of a file"));
        }
        let path = match fs::canonicalize(path) {
            // Through a symbolic link the file is replaced, not the link.
            Ok(path) if !in_place => path,
            _ => path.to_owned(),
        };
        let output = Self { path, in_place };
        if !in_place {
            output.temporary().map_err(|e| output.failure(&e))?;
        }
        Ok(output)
    }

    /// Where the file goes, to be moved there.
    ///
    /// # Errors
    /// Where a pipe or a device is there, which a move would replace.
    pub(crate) fn place(&self) -> Result<&Path, Failure> {
        if self.in_place {
            return Err(Failure::at(&self.path, "is not an ordinary file"));
        }
        Ok(&self.path)
    }

    /// Writes the whole file, or nothing.
    ///
    /// # Errors
    /// Where the system does.
    pub(crate) fn write(
        &self,
        content: impl FnOnce(&mut BufWriter<&mut File>) -> io::Result<()>,
    ) -> Result<(), Failure> {
        self.try_write(content).map_err(|e| self.failure(&e))
    }

    fn try_write(&self, content: impl FnOnce(&mut BufWriter<&mut File>) -> io::Result<()>) -> io::Result<()> {
        let fill = |file: &mut File| {
            let mut writer = BufWriter::new(file);
            content(&mut writer)?;
            writer.flush()
        };
        if self.in_place {
            return fill(&mut File::options().write(true).open(&self.path)?);
        }
        let mut temporary = self.temporary()?;
        fill(temporary.as_file_mut())?;
        temporary.persist(&self.path)?;
        Ok(())
    }

    fn temporary(&self) -> io::Result<NamedTempFile> {
        let mut builder = tempfile::Builder::new();
        // The default is for secrets; an ordinary file leaves its permissions to the umask.
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
        builder.tempfile_in(folder(&self.path))
    }

    fn failure(&self, error: &io::Error) -> Failure {
        let what = match error.kind() {
            ErrorKind::NotFound => "the folder does not exist".to_owned(),
            _ => error.to_string(),
        };
        Failure::at(&self.path, format_args!("can't write: {what}"))
    }
}

/// The folder that a file is in.
pub(crate) fn folder(path: &Path) -> &Path {
    path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Prints lines on standard output. A reader that has gone away is no failure.
///
/// # Errors
/// Where standard output can't be written otherwise.
pub(crate) fn say(text: impl std::fmt::Display) -> Result<(), Failure> {
    match writeln!(io::stdout(), "{text}").and_then(|()| io::stdout().flush()) {
        Err(e) if e.kind() != ErrorKind::BrokenPipe => {
            Err(Failure::Expected(format!("can't write to standard output: {e}")))
        }
        _ => Ok(()),
    }
}

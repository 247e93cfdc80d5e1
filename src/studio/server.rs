//! The server: a listener on the loopback interface, and one thread per connection.

use super::access::Access;
use super::connections::Connections;
use super::http::Connection;
use super::invitation::Invitation;
use super::reading::Files;
use super::routes::ServerState;
use std::net::{Ipv4Addr, TcpListener, TcpStream};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;
use thiserror::Error;

/// Default port. If this port is free, every session uses it, so that a browser finds the data that it stored in earlier
/// sessions.
const USUAL_PORT: u16 = 7353;
/// Interval between two checks whether the server must stop. Also the pause after a failed connection.
const LOOK: Duration = Duration::from_millis(100);

/// Reason why a study is not served.
#[derive(Debug, Error)]
pub enum NotServed {
    /// The study contains errors, described in words.
    #[error("{0}")]
    Study(String),
    /// The port is not available.
    #[error("cannot listen on port {port} of this machine: {source}")]
    Port {
        /// Requested port.
        port: u16,
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// The operating system refuses a resource that the server needs.
    #[error("cannot serve: {0}")]
    System(#[from] std::io::Error),
}

/// Server of a study for a browser on this machine.
pub struct Studio {
    listener: TcpListener,
    server: Arc<ServerState>,
}

impl Studio {
    /// Reads a study, and listens on a port of 127.0.0.1. Without `port` it uses the default port, or any free port if the
    /// default port is taken.
    ///
    /// # Errors
    /// If the study cannot be read or has errors, if `port` is not available, or if the system refuses a resource.
    pub fn open(study: &Path, port: Option<u16>) -> Result<Self, NotServed> {
        let shown = study.display();
        let wrong = |why: String| NotServed::Study(why);
        let file = Files::at(study).map_err(|e| wrong(format!("{shown}: cannot be read: {e}")))?;
        let opened = file.read().map_err(wrong)?;
        let directory = file.path().parent().unwrap_or(Path::new("")).to_owned();
        let studio = Self::choose(directory, port)?;
        studio.server.take(file, opened).map_err(wrong)?;
        Ok(studio)
    }

    /// Listens without a study. The page asks for a topology, and the server writes the new study into `directory`.
    ///
    /// # Errors
    /// If `port` is not available, or if the system refuses a resource.
    pub fn choose(directory: PathBuf, port: Option<u16>) -> Result<Self, NotServed> {
        let listen = |port: u16| TcpListener::bind((Ipv4Addr::LOCALHOST, port));
        let listener = match port {
            Some(port) => listen(port).map_err(|source| NotServed::Port { port, source })?,
            None => listen(USUAL_PORT).or_else(|_| listen(0))?,
        };
        let access = Access::new(listener.local_addr()?)?;
        Ok(Studio {
            listener,
            server: Arc::new(ServerState::new(access, directory)),
        })
    }

    /// Address of the page. It contains the secret token.
    pub fn address(&self) -> String {
        self.server.access.address()
    }

    /// Answers requests of the page until `stop` is true. The file that leads the browser to the page (`invitation`) is deleted
    /// after the first request of the page, or at the end.
    ///
    /// # Errors
    /// If the address of the server is not known, or the thread that waits for connections cannot be started.
    pub fn serve(
        self,
        stop: &AtomicBool,
        mut invitation: Option<Invitation>,
    ) -> std::io::Result<()> {
        let Studio { listener, server } = self;
        let address = listener.local_addr()?;
        let closes = Arc::new(AtomicBool::new(false));
        let flag = closes.clone();
        let served = server.clone();
        let accepting =
            std::thread::Builder::new().spawn(move || accept(&listener, &served, &flag))?;
        while !stop.load(Ordering::SeqCst) {
            if server.visited.load(Ordering::SeqCst) {
                invitation = None;
            }
            std::thread::sleep(LOOK);
        }
        drop(invitation);
        closes.store(true, Ordering::SeqCst);
        // A last connection wakes the thread, which then closes the port.
        if TcpStream::connect_timeout(&address, LOOK).is_ok() {
            let _ = accepting.join();
        }
        Ok(())
    }
}

/// Accepts connections, each on its own thread, until `closes` is true.
fn accept(listener: &TcpListener, server: &Arc<ServerState>, closes: &AtomicBool) {
    let connections = Arc::new(Connections::default());
    for stream in listener.incoming() {
        if closes.load(Ordering::SeqCst) {
            return;
        }
        let Ok(stream) = stream else {
            // The connection failed, for example because too many files are open. Then other connections must close first.
            std::thread::sleep(LOOK);
            continue;
        };
        let Ok(mut place) = connections.enter(&stream) else {
            continue;
        };
        let server = server.clone();
        // If no thread can be started, the connection is closed.
        let _ = std::thread::Builder::new().spawn(move || {
            if let Ok(mut connection) = Connection::new(stream) {
                server.serve(&mut connection, &mut place);
            }
        });
    }
}

//! Limits for connections: a few for connections without the token, more for connections that have shown the token.
//!
//! Every program on this machine can connect and then send nothing. Such connections share [`MOST_STRANGERS`] slots. If all
//! slots are taken, a new connection replaces the oldest one. So idle connections never keep the user out. A connection that
//! shows the token moves to one of [`MOST_ADMITTED`] separate slots.

use std::collections::VecDeque;
use std::net::{Shutdown, TcpStream};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Largest number of connections that have not shown the token.
const MOST_STRANGERS: usize = 64;
/// Largest number of connections that have shown the token. A browser tab uses up to six.
const MOST_ADMITTED: usize = 64;

/// Open connections.
#[derive(Default)]
pub(super) struct Connections {
    open: Mutex<Open>,
}

#[derive(Default)]
struct Open {
    latest: u64,
    /// Connections without the token, with their numbers, the oldest first.
    strangers: VecDeque<(u64, TcpStream)>,
    admitted: usize,
}

/// Slot of one connection. The slot becomes free again, however the connection's thread ends.
pub(super) struct Place {
    connections: Arc<Connections>,
    number: u64,
    is_admitted: bool,
}

impl Connections {
    /// Gives a new connection a slot for connections without the token. If all slots are taken, it closes the oldest connection.
    ///
    /// # Errors
    /// If the system cannot duplicate the connection.
    pub(super) fn enter(self: &Arc<Self>, stream: &TcpStream) -> std::io::Result<Place> {
        let stream = stream.try_clone()?;
        let mut open = self.locked();
        if open.strangers.len() >= MOST_STRANGERS
            && let Some((_, oldest)) = open.strangers.pop_front()
        {
            // The connection may be closed already. The thread of the connection notices the end of the stream.
            let _ = oldest.shutdown(Shutdown::Both);
        }
        open.latest += 1;
        let number = open.latest;
        open.strangers.push_back((number, stream));
        Ok(Place {
            connections: self.clone(),
            number,
            is_admitted: false,
        })
    }

    fn locked(&self) -> MutexGuard<'_, Open> {
        self.open.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Place {
    /// Moves a connection that has shown the token to one of the [`MOST_ADMITTED`] slots. Returns false if all of these slots
    /// are taken.
    pub(super) fn admit(&mut self) -> bool {
        if self.is_admitted {
            return true;
        }
        let mut open = self.connections.locked();
        if open.admitted >= MOST_ADMITTED {
            return false;
        }
        open.strangers.retain(|(number, _)| *number != self.number);
        open.admitted += 1;
        self.is_admitted = true;
        true
    }
}

impl Drop for Place {
    fn drop(&mut self) {
        let mut open = self.connections.locked();
        if self.is_admitted {
            open.admitted -= 1;
        } else {
            open.strangers.retain(|(number, _)| *number != self.number);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Read;
    use std::net::{Ipv4Addr, TcpListener};

    #[test]
    fn the_oldest_stranger_makes_room_and_the_admitted_stay() {
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).unwrap();
        let address = listener.local_addr().unwrap();
        let connections = Arc::new(Connections::default());
        let connect = || {
            let client = TcpStream::connect(address).unwrap();
            let (server, _) = listener.accept().unwrap();
            let place = connections.enter(&server).unwrap();
            (client, server, place)
        };
        let mut owner = connect();
        assert!(owner.2.admit() && owner.2.admit());
        let mut crowd: Vec<_> = (0..=MOST_STRANGERS).map(|_| connect()).collect();
        assert_eq!(connections.locked().strangers.len(), MOST_STRANGERS);
        assert_eq!(crowd[0].1.read(&mut [0]).unwrap(), 0, "closed");
        for (_, server, _) in [&mut crowd[1], &mut owner] {
            server.set_nonblocking(true).unwrap();
            let waits = server.read(&mut [0]).unwrap_err();
            assert_eq!(waits.kind(), std::io::ErrorKind::WouldBlock);
        }
        drop(crowd);
        drop(owner);
        let open = connections.locked();
        assert_eq!((open.strangers.len(), open.admitted), (0, 0));
    }
}

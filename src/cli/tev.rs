//! Shows a picture while it is rendered in tev (<https://github.com/Tom94/tev>), or another program that speaks its protocol.
//!
//! The protocol (tev's `Ipc.h`): over TCP, packets of a length of 32 bits that counts itself, a byte that says what is asked, and its arguments; all numbers little-endian,
//! texts end with a zero. Nothing is answered. Packets are sent from a thread of their own, so that a slow server costs pictures of passes and no time.

use std::io::{self, Write};
use std::net::{TcpStream, ToSocketAddrs};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread::JoinHandle;
use std::time::Duration;

use anyhow::Context;
use bspray::render::PixelRect;
use glam::Vec3;

use super::output;

/// How long a server may take to be there, and to take a packet.
const PATIENCE: Duration = Duration::from_secs(5);

/// Rows that are sent in one packet.
const ROWS: u32 = 64;

/// The protocol's numbers for what is asked.
const CREATE_IMAGE: u8 = 4;
const UPDATE_IMAGE_V3: u8 = 6;

/// Channels of an image: linear radiance.
const CHANNELS: [&str; 3] = ["R", "G", "B"];

/// A server that shows pictures. When it is dropped, what was handed over has been sent.
pub(super) struct Server {
    /// `None` only while it is dropped.
    jobs: Option<SyncSender<Job>>,
    thread: Option<JoinHandle<()>>,
}

/// Something to be sent.
enum Job {
    Create(String, (u32, u32)),
    Update(String, PixelRect, Vec<Vec3>),
}

impl Server {
    /// Connects to `HOST:PORT`.
    ///
    /// # Errors
    /// There is no such host, or nobody listens there.
    pub(super) fn connect(address: &str, quiet: bool) -> anyhow::Result<Self> {
        let stream = open(address)
            .with_context(|| format!("--display-server {address}: cannot be reached"))?;
        let (jobs, received) = sync_channel(1);
        let name = address.to_owned();
        let work = move || {
            // Once it is gone, the rest is not sent; the picture is what counts.
            if let Err(error) = send_all(stream, &received)
                && !quiet
            {
                output::message(&format!("the display server {name} is gone: {error}"));
            }
        };
        let thread = std::thread::Builder::new().name("display".to_owned());
        Ok(Self {
            jobs: Some(jobs),
            thread: Some(thread.spawn(work).context("cannot start a thread")?),
        })
    }

    /// Shows a new image of that name, width and height, black at first.
    pub(super) fn create(&self, name: &str, size: (u32, u32)) {
        self.hand_over(Job::Create(name.to_owned(), size));
    }

    /// Shows pixels of an image, row by row, if the server has taken those before.
    pub(super) fn offer(&self, name: &str, window: PixelRect, pixels: Vec<Vec3>) {
        if let Some(jobs) = &self.jobs {
            // Those of the next pass are better anyway.
            let _ = jobs.try_send(Job::Update(name.to_owned(), window, pixels));
        }
    }

    /// Shows pixels of an image for good.
    pub(super) fn finish(&self, name: &str, window: PixelRect, pixels: Vec<Vec3>) {
        self.hand_over(Job::Update(name.to_owned(), window, pixels));
    }

    fn hand_over(&self, job: Job) {
        if let Some(jobs) = &self.jobs {
            // Of a server that is gone it was told already.
            let _ = jobs.send(job);
        }
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        self.jobs = None;
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

fn open(address: &str) -> io::Result<TcpStream> {
    let mut last = io::Error::new(io::ErrorKind::NotFound, "the host has no address");
    for place in address.to_socket_addrs()? {
        match TcpStream::connect_timeout(&place, PATIENCE) {
            Ok(stream) => {
                stream.set_write_timeout(Some(PATIENCE))?;
                stream.set_nodelay(true)?;
                return Ok(stream);
            }
            Err(error) => last = error,
        }
    }
    Err(last)
}

fn send_all(mut stream: TcpStream, jobs: &Receiver<Job>) -> io::Result<()> {
    for job in jobs {
        match job {
            Job::Create(name, size) => stream.write_all(&create(&name, size))?,
            Job::Update(name, window, pixels) => {
                let rows = pixels.chunks(window.width as usize * ROWS as usize);
                for (band, pixels) in (0..).zip(rows) {
                    let part = PixelRect {
                        y: window.y + band * ROWS,
                        height: ROWS.min(window.height - band * ROWS),
                        ..window
                    };
                    stream.write_all(&update(&name, part, pixels))?;
                }
            }
        }
    }
    Ok(())
}

/// A packet being written.
struct Packet(Vec<u8>);

impl Packet {
    fn new(kind: u8) -> Self {
        // The length comes last; and no window is brought to the front.
        Self(vec![0, 0, 0, 0, kind, 0])
    }

    fn text(mut self, text: &str) -> Self {
        // A zero would end it.
        self.0.extend(text.bytes().filter(|&b| b != 0));
        self.0.push(0);
        self
    }

    fn number(mut self, number: u32) -> Self {
        self.0.extend(number.to_le_bytes());
        self
    }

    fn channels(self) -> Self {
        let packet = self.number(CHANNELS.len() as u32);
        CHANNELS
            .iter()
            .fold(packet, |packet, name| packet.text(name))
    }

    fn finished(mut self) -> Vec<u8> {
        let length = self.0.len() as u32;
        self.0[..4].copy_from_slice(&length.to_le_bytes());
        self.0
    }
}

fn create(name: &str, (width, height): (u32, u32)) -> Vec<u8> {
    Packet::new(CREATE_IMAGE)
        .text(name)
        .number(width)
        .number(height)
        .channels()
        .finished()
}

fn update(name: &str, part: PixelRect, pixels: &[Vec3]) -> Vec<u8> {
    let mut packet = Packet::new(UPDATE_IMAGE_V3)
        .text(name)
        .channels()
        .number(part.x)
        .number(part.y)
        .number(part.width)
        .number(part.height);
    // Where each channel begins among the values, and how far apart its values are.
    let count = CHANNELS.len() as u64;
    for place in (0..count).chain(CHANNELS.map(|_| count)) {
        packet.0.extend(place.to_le_bytes());
    }
    let values = pixels.iter().flat_map(|pixel| pixel.to_array());
    packet.0.extend(values.flat_map(f32::to_le_bytes));
    packet.finished()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn packets_are_those_of_the_protocol() {
        // Byte by byte as the author's own client writes them.
        let mut want = vec![4, 0];
        want.extend(b"a.png\0");
        want.extend([44, 1, 0, 0, 200, 0, 0, 0, 3, 0, 0, 0]);
        want.extend(b"R\0G\0B\0");
        let packet = create("a.png", (300, 200));
        assert_eq!(packet[..4], (packet.len() as u32).to_le_bytes());
        assert_eq!(packet[4..], want);
        let part = PixelRect {
            x: 5,
            y: 64,
            width: 1,
            height: 1,
        };
        let packet = update("b", part, &[Vec3::new(1.0, -2.0, 0.5)]);
        let mut want = vec![6, 0, b'b', 0, 3, 0, 0, 0];
        want.extend(b"R\0G\0B\0");
        for number in [5_u32, 64, 1, 1] {
            want.extend(number.to_le_bytes());
        }
        for number in [0_i64, 1, 2, 3, 3, 3] {
            want.extend(number.to_le_bytes());
        }
        for value in [1.0_f32, -2.0, 0.5] {
            want.extend(value.to_le_bytes());
        }
        assert_eq!(packet[4..], want);
        assert_eq!(packet[..4], (packet.len() as u32).to_le_bytes());
    }
}

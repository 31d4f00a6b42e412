//! Lets isograde grade a program in Rust.
//!
//! Implement [`Extract`] and call [`serve`] in `main`: it reads requests from standard input until
//! there are no more, calls `extract` for each, and answers. Samples keep their type, but float16
//! comes as `f32`, and bool as `u8`. The declaration is JSON (`isograde explain declaration`).
//! Answers go to descriptor 3, so that whoever prints does no harm: `run` sees to it.

use std::fs::File;
use std::io::{self, BufRead, Read, Seek, SeekFrom, Write};

/// Vertices are index * spacing; triangles are three vertices each, counted from 0,
/// counterclockwise seen from where values are low.
#[derive(Default)]
pub struct Mesh {
    pub vertices: Vec<[f64; 3]>,
    pub triangles: Vec<[usize; 3]>,
}

/// From samples in C order, the last axis fastest, to a mesh, or to what is wrong.
pub trait Extract {
    #[rustfmt::skip]
    fn extract<T: Sample>(
        &self, values: &[T], shape: [usize; 3], isovalue: f64, spacing: [f64; 3],
    ) -> Result<Mesh, String>;
}

/// A type of samples.
pub trait Sample: Copy {
    /// The sample as a double. A 64-bit integer that no double holds is rounded down, so that the
    /// double is at least the isovalue exactly where the sample is.
    fn number(self) -> f64;
    /// The sample in these bytes, little-endian.
    fn read(bytes: &[u8]) -> Self;
}

macro_rules! samples {
    (|$sample:ident| $number:expr; $($type:ident),*) => {$(
        impl Sample for $type {
            fn number(self) -> f64 {
                let $sample = self;
                $number
            }
            fn read(bytes: &[u8]) -> Self {
                Self::from_le_bytes(bytes.try_into().expect("as many bytes as the type has"))
            }
        }
    )*};
}
samples!(|v| f64::from(v); i8, i16, i32, u8, u16, u32, f32, f64);
samples!(|v| down(v as f64, v.into()); i64, u64);

/// The double, or the next below it where it is above the whole number.
fn down(wide: f64, whole: i128) -> f64 {
    let away = if wide > 0.0 { -1 } else { 1 };
    let steps = if wide as i128 > whole { away } else { 0 };
    f64::from_bits(wide.to_bits().wrapping_add_signed(steps))
}

/// The float with these 16 bits.
fn widened(half: u16) -> f32 {
    let (power, part) = (i32::from(half >> 10 & 31), f32::from(half & 1023));
    let wide = match (power, part) {
        (31, 0.0) => f32::INFINITY,
        (31, _) => f32::NAN,
        (0, _) => part * 2f32.powi(-24),
        _ => (part + 1024.0) * 2f32.powi(power - 25),
    };
    wide.copysign(0.5 - f32::from(half >> 15))
}

/// What a request, a line of JSON, says under a key, without quotes or brackets.
fn said<'a>(line: &'a str, key: &str) -> &'a str {
    let rest = line.split_once(&format!("\"{key}\": ")).map_or("", |(_, rest)| rest);
    match rest.chars().next() {
        Some('"') => rest[1..].split('"').next().unwrap_or(""),
        Some('[') => rest[1..].split(']').next().unwrap_or(""),
        _ => rest.split([',', '}']).next().unwrap_or(""),
    }
}

/// So many numbers of a list, NaN where JSON has none.
fn list<const N: usize>(line: &str, key: &str) -> Result<[f64; N], String> {
    let parts = said(line, key).split(',').map(|one| one.trim_matches([' ', '"']));
    let numbers = parts.map(|one| one.parse().unwrap_or(f64::NAN));
    let found = numbers.collect::<Vec<f64>>().try_into();
    found.map_err(|_| String::from("it takes one field with three axes"))
}

/// The mesh that a request asks for.
fn answer(line: &str, extractor: &impl Extract) -> Result<Mesh, String> {
    let shape = list::<3>(line, "shape")?.map(|length| length as usize);
    let ([isovalue], spacing) = (list(line, "isovalues")?, list(line, "spacing")?);
    let (order, kind) = said(line, "dtype").split_at(1);
    let size = kind[1..].parse().map_err(|_| format!("samples of an unknown type: {kind}"))?;
    let offset = said(line, "offset").parse().map_err(|_| "the request has no offset")?;
    let mut bytes = vec![0; shape.iter().product::<usize>() * size];
    let mut file = File::open(said(line, "values")).map_err(|error| error.to_string())?;
    file.seek(SeekFrom::Start(offset)).map_err(|error| error.to_string())?;
    file.read_exact(&mut bytes).map_err(|error| error.to_string())?;
    if order == ">" {
        bytes.chunks_exact_mut(size).for_each(|one| one.reverse());
    }
    macro_rules! call {
        ($type:ty, $read:expr) => {{
            let values: Vec<$type> = bytes.chunks_exact(size).map($read).collect();
            extractor.extract(&values, shape, isovalue, spacing)
        }};
    }
    match kind {
        "b1" | "u1" => call!(u8, Sample::read),
        "u2" => call!(u16, Sample::read),
        "u4" => call!(u32, Sample::read),
        "u8" => call!(u64, Sample::read),
        "i1" => call!(i8, Sample::read),
        "i2" => call!(i16, Sample::read),
        "i4" => call!(i32, Sample::read),
        "i8" => call!(i64, Sample::read),
        "f2" => call!(f32, |half| widened(Sample::read(half))),
        "f4" => call!(f32, Sample::read),
        "f8" => call!(f64, Sample::read),
        _ => Err(format!("samples of an unknown type: {kind}")),
    }
}

/// Answers every request with a line.
pub fn serve(declaration: &str, extractor: &impl Extract) -> io::Result<()> {
    let mut answers = File::options().append(true).open("/dev/fd/3")?;
    for line in io::stdin().lock().lines() {
        let line = line?;
        let text = match said(&line, "command") {
            "stop" => break,
            "start" => format!("{{\"protocol\": 3, \"declaration\": {declaration}}}\n"),
            _ => match answer(&line, extractor) {
                Err(wrong) => {
                    let wrong = wrong.replace(['"', '\\', '\n'], "'");
                    format!("{{\"id\": {}, \"error\": \"{wrong}\"}}\n", said(&line, "id"))
                }
                Ok(Mesh { vertices, triangles }) => {
                    let points = format!("{vertices:?}").replace("-inf", "inf");
                    let points = points.replace("inf", "null").replace("NaN", "null");
                    let rows = format!("\"vertices\": {points}, \"simplices\": {triangles:?}");
                    format!("{{\"id\": {}, {rows}}}\n", said(&line, "id"))
                }
            },
        };
        answers.write_all(text.as_bytes())?;
    }
    Ok(())
}

//! What the Rust crates of the league share: samples turned round, meshes from flat lists, and the
//! cost of a call. It stands beside the kit for Rust (`isograde.rs`), and answers through it.

use crate::isograde::{self, Extract, Mesh, Sample};
use std::{env, fs, io::Write, time::Instant};

/// The samples in C order as numbers with the first axis fastest.
pub fn x_fastest<T: Sample>(values: &[T], shape: [usize; 3], number: impl Fn(f64) -> f32) -> Vec<f32> {
    let [nx, ny, nz] = shape;
    let mut turned = Vec::with_capacity(values.len());
    for z in 0..nz {
        for y in 0..ny {
            turned.extend((0..nx).map(|x| number(values[(x * ny + y) * nz + z].number())));
        }
    }
    turned
}

/// Three indices a triangle.
pub fn threes<I: Copy + TryInto<usize>>(flat: &[I]) -> Vec<[usize; 3]> {
    let index = |at: I| at.try_into().unwrap_or(usize::MAX);
    flat.chunks_exact(3).map(|t| [index(t[0]), index(t[1]), index(t[2])]).collect()
}

/// Three numbers a vertex.
pub fn places(flat: &[f32]) -> Vec<[f64; 3]> {
    flat.chunks_exact(3).map(|p| [p[0], p[1], p[2]].map(f64::from)).collect()
}

/// Answers the grader: the first argument is the file of the declaration.
pub fn serve(extractor: impl Extract) -> std::io::Result<()> {
    let declaration = env::args().nth(1).expect("the file of the declaration");
    isograde::serve(&fs::read_to_string(declaration)?, &Costed(extractor))
}

/// The second argument, which method is meant.
pub fn method() -> String {
    env::args().nth(2).unwrap_or_default()
}

/// An extractor that writes what each call costs into the file that ISOGRADE_COST names.
struct Costed<E>(E);

impl<E: Extract> Extract for Costed<E> {
    #[rustfmt::skip]
    fn extract<T: Sample>(
        &self, values: &[T], shape: [usize; 3], isovalue: f64, spacing: [f64; 3],
    ) -> Result<Mesh, String> {
        let Ok(path) = env::var("ISOGRADE_COST") else {
            return self.0.extract(values, shape, isovalue, spacing);
        };
        let before = memory("VmRSS:");
        fs::write("/proc/self/clear_refs", "5").ok();
        let (start, used) = (Instant::now(), processor());
        let found = self.0.extract(values, shape, isovalue, spacing);
        let (seconds, used) = (start.elapsed().as_secs_f64(), processor() - used);
        let more = memory("VmHWM:") - before;
        let file = fs::File::options().append(true).create(true).open(path);
        file.and_then(|mut file| writeln!(file, "{seconds} {used} {more}")).map_err(|e| e.to_string())?;
        found
    }
}

/// Kilobytes of this process, as Linux counts them; 0 elsewhere.
fn memory(name: &str) -> i64 {
    let told = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = told.lines().find(|line| line.starts_with(name)).unwrap_or_default();
    line.split_whitespace().nth(1).and_then(|word| word.parse().ok()).unwrap_or(0)
}

extern "C" {
    fn clock() -> std::ffi::c_long;
}

/// Seconds of the processor that this process has used; POSIX counts millionths.
fn processor() -> f64 {
    unsafe { clock() as f64 / 1e6 }
}

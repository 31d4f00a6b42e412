//! isosurface: methods that sample a function in the unit cube, here of cubes of samples.

mod isograde;
mod league;
use isograde::{Extract, Mesh, Sample as Number};
use isosurface::distance::Signed;
use isosurface::extractor::IndexedVertices;
use isosurface::feature::ParticleBasedMinimisation;
use isosurface::math::Vec3;
use isosurface::sampler::Sampler;
use isosurface::source::{HermiteSource, ScalarSource};
use isosurface::{DualContouring, MarchingCubes};

struct Method(String);

/// Samples of the unit cube, positive outside; what lies beyond is as at its face.
struct Samples {
    n: usize,
    values: Vec<f32>,
}

impl Samples {
    fn at(&self, x: usize, y: usize, z: usize) -> f32 {
        let inside = |i: usize| i.min(self.n - 1);
        self.values[(inside(x) * self.n + inside(y)) * self.n + inside(z)]
    }
}

/// The sample at a point of the lattice, and between such points what is trilinear.
impl ScalarSource for Samples {
    fn sample_scalar(&self, p: Vec3) -> Signed {
        let [x, y, z] = [p.x, p.y, p.z].map(|a| (a * (self.n - 1) as f32).max(0.0));
        let near = [x, y, z].map(f32::round);
        if [x, y, z].iter().zip(near).all(|(a, b)| (a - b).abs() < 1e-5 * self.n as f32) {
            let [i, j, k] = near.map(|a| a as usize);
            return Signed(self.at(i, j, k));
        }
        let [i, j, k] = [x, y, z].map(|a| a as usize);
        let [u, v, w] = [x.fract(), y.fract(), z.fract()];
        let along = |j, k| self.at(i, j, k) * (1.0 - u) + self.at(i + 1, j, k) * u;
        let across = |k| along(j, k) * (1.0 - v) + along(j + 1, k) * v;
        Signed(across(k) * (1.0 - w) + across(k + 1) * w)
    }
}

/// The unit normal, from low to high, by differences over a hundredth of a cell.
impl HermiteSource for Samples {
    fn sample_normal(&self, p: Vec3) -> Vec3 {
        let step = 0.01 / (self.n - 1) as f32;
        let along = |d: Vec3| self.sample_scalar(p + d).0 - self.sample_scalar(p - d).0;
        let normal = Vec3::new(
            along(Vec3::new(step, 0.0, 0.0)),
            along(Vec3::new(0.0, step, 0.0)),
            along(Vec3::new(0.0, 0.0, step)),
        );
        normal.normalised().unwrap_or(normal)
    }
}

impl Extract for Method {
    #[rustfmt::skip]
    fn extract<T: Number>(
        &self, values: &[T], shape: [usize; 3], isovalue: f64, _spacing: [f64; 3],
    ) -> Result<Mesh, String> {
        let n = shape[0];
        let values = values.iter().map(|v| (isovalue - v.number()) as f32).collect();
        let source = Samples { n, values };
        let (mut vertices, mut indices) = (vec![], vec![]);
        let mut found = IndexedVertices::new(&mut vertices, &mut indices);
        if self.0 == "dual_contouring" {
            let method = ParticleBasedMinimisation {};
            DualContouring::new(n, method).extract(&Sampler::new(&source), &mut found);
        } else {
            MarchingCubes::<Signed>::new(n).extract(&Sampler::new(&source), &mut found);
        }
        let cells = (n - 1) as f64;
        Ok(Mesh {
            vertices: league::places(&vertices).iter().map(|p| p.map(|a| a * cells)).collect(),
            triangles: league::threes(&indices),
        })
    }
}

fn main() -> std::io::Result<()> {
    league::serve(Method(league::method()))
}

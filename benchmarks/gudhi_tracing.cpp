// GUDHI's manifold tracing of a sphere, timed call by call: it answers lines as `outside.py` says.
//
//   gudhi_tracing DIMENSION N RADIUS EDGE
//
// The sphere of this radius about the origin, in the cube of this edge about it, on Kuhn's
// triangulation of N cells a side (GUDHI calls it Freudenthal's): the lattice that isoref.simplicial
// cuts as well, so the vertices are as many. A call traces the simplices that are met; a call of
// "cells" also makes the complex of all cells, which is what a mesh is read from.
#include <iostream>  // Cell_complex.h of GUDHI 3.7 leaves it to us.

#include <gudhi/Coxeter_triangulation/Cell_complex/Cell_complex.h>
#include <gudhi/Freudenthal_triangulation.h>
#include <gudhi/Functions/Function_Sm_in_Rd.h>
#include <gudhi/Implicit_manifold_intersection_oracle.h>
#include <gudhi/Manifold_tracing.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <string>
#include <vector>

using namespace Gudhi::coxeter_triangulation;
using Triangulation = Freudenthal_triangulation<>;
using Tracing = Manifold_tracing<Triangulation>;

int main(int count, char** given) {
  if (count != 5) return 2;
  const int dimension = std::atoi(given[1]);
  const double cells = std::atof(given[2]), radius = std::atof(given[3]), edge = std::atof(given[4]);
  const Function_Sm_in_Rd sphere(radius, dimension - 1);
  const auto oracle = make_oracle(sphere);
  const Triangulation lattice(dimension,
                              edge / cells * Eigen::MatrixXd::Identity(dimension, dimension),
                              Eigen::VectorXd::Constant(dimension, -edge / 2));
  const std::vector<Eigen::VectorXd> seeds(1, sphere.seed());
  const auto run = [&](bool whole) {
    Tracing::Out_simplex_map found;
    manifold_tracing_algorithm(seeds, lattice, oracle, found);
    if (whole) {
      Cell_complex<Tracing::Out_simplex_map> complex(dimension - 1);
      complex.construct_complex(found);
      return std::pair<std::size_t, std::size_t>(
          found.size(), complex.interior_simplex_cell_map(dimension - 1).size());
    }
    return std::pair<std::size_t, std::size_t>(found.size(), 0);
  };
  run(false);
  std::cout << "> ready doubles" << std::endl;
  for (std::string line; std::getline(std::cin, line) && line != "end";) {
    const auto clock = std::chrono::steady_clock::now();
    const std::clock_t used = std::clock();
    const auto made = run(line == "cells");
    const double spent = double(std::clock() - used) / CLOCKS_PER_SEC;
    const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - clock;
    std::printf("> %.9f %.9f %zu %zu\n", passed.count(), spent, made.first, made.second);
    std::fflush(stdout);
  }
}

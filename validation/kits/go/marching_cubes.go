// Marching cubes in Go, the example of the kit: put your own extractor in its place.
//
// A sample is inside where it is at least the isovalue. Each pattern of inside corners has its
// triangles in table.go, which cuts the inside corners of an ambiguous face apart, on every face
// alike: so the surface is closed. A vertex belongs to a lattice edge, named by the sample at its
// lower end and its axis, and is made by the first cell that asks for it.
package main

import (
	"errors"
	"log"
	"math"
)

// crossing is where between two samples, one inside, the line through both takes the isovalue: 0 to
// 1. Low and high are the samples minus the isovalue.
func crossing(low, high float64) float64 {
	if low == 0 {
		return 0
	}
	return 1 / (1 - high/low)
}

func extract[T Sample](values []T, shape [3]int, isovalue float64, spacing [3]float64,
) (mesh Mesh, err error) {
	if len(values) == 0 {
		return mesh, errors.New("there are no samples")
	}
	for _, value := range values {
		if away := Number(value) - isovalue; math.IsNaN(away) || math.IsInf(away, 0) {
			return mesh, errors.New("a sample minus the isovalue is no finite number")
		}
	}

	stride := [3]int{shape[1] * shape[2], shape[2], 1}
	vertex := make([]int, 3*len(values)) // On each lattice edge, from 1; 0 where there is none.
	var cell [3]int
	for cell[0] = 0; cell[0]+1 < shape[0]; cell[0]++ {
		for cell[1] = 0; cell[1]+1 < shape[1]; cell[1]++ {
			for cell[2] = 0; cell[2]+1 < shape[2]; cell[2]++ {
				// Read the samples at the corners; bit a of c is a step along axis a.
				var corner [8]int
				var level [8]float64
				signs := 0
				for c := range corner {
					for a := range cell {
						corner[c] += (cell[a] + c>>a&1) * stride[a]
					}
					level[c] = Number(values[corner[c]]) - isovalue
					if level[c] >= 0 {
						signs |= 1 << c
					}
				}

				// Copy the triangles of these signs; make the vertices that are not there yet.
				for letters := triangles[signs]; letters != ""; letters = letters[3:] {
					var triangle [3]int
					for k := range triangle {
						edge := int(letters[k] - 'a')
						low, axis := lower[edge], edge/4
						name := &vertex[3*corner[low]+axis]
						if *name == 0 {
							var at [3]float64
							for a := range at {
								at[a] = float64(cell[a] + low>>a&1)
							}
							at[axis] += crossing(level[low], level[low|1<<axis])
							for a := range at {
								at[a] *= spacing[a]
							}
							mesh.Vertices = append(mesh.Vertices, at)
							*name = len(mesh.Vertices)
						}
						triangle[k] = *name - 1
					}
					mesh.Triangles = append(mesh.Triangles, triangle)
				}
			}
		}
	}
	return mesh, nil
}

func main() {
	if err := Serve(`{"name": "marching cubes in Go", "version": "1"}`); err != nil {
		log.Fatal(err)
	}
}

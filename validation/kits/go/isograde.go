// Lets isograde grade a program in Go. In the same package stands the extractor,
//
//	func extract[T Sample](values []T, shape [3]int, isovalue float64, spacing [3]float64) (Mesh, error)
//
// and main calls Serve, which reads requests from standard input until there are no more, calls
// extract for each, and answers. Samples are in C order and keep their type, but float16 comes as
// float32, and bool as uint8. Answers go to descriptor 3, so that whoever prints does no harm.
package main

import (
	"encoding/binary"
	"encoding/json"
	"fmt"
	"io"
	"math"
	"os"
)

// Sample is a type of samples.
type Sample interface {
	int8 | int16 | int32 | int64 | uint8 | uint16 | uint32 | uint64 | float32 | float64
}

// Mesh has vertices, index * spacing, and triangles: three vertices each, counted from 0,
// counterclockwise seen from where values are low.
type Mesh struct {
	Vertices  [][3]float64
	Triangles [][3]int
}

// Number is the sample as a float64. A 64-bit integer that no float64 holds is rounded down, so
// that the float64 is at least the isovalue exactly where the sample is.
func Number[T Sample](value T) float64 {
	wide, above := float64(value), false
	switch whole := any(value).(type) {
	case int64:
		above = wide >= 0x1p63 || int64(wide) > whole
	case uint64:
		above = wide >= 0x1p64 || uint64(wide) > whole
	}
	if above {
		return math.Nextafter(wide, math.Inf(-1))
	}
	return wide
}

// request is a line of the protocol. An isovalue that is not finite is a text.
type request struct {
	Command, Dtype, Values string
	ID                     int
	Shape                  []int
	Isovalues              []any
	Spacing                []float64
	Offset                 int64
}

// samples reads the samples, each as wide as T.
func samples[T any](asked request) ([]T, error) {
	values := make([]T, asked.Shape[0]*asked.Shape[1]*asked.Shape[2])
	file, err := os.Open(asked.Values)
	if err != nil {
		return nil, err
	}
	defer file.Close()
	rest := io.NewSectionReader(file, asked.Offset, math.MaxInt64-asked.Offset)
	order := binary.ByteOrder(binary.LittleEndian)
	if asked.Dtype[0] == '>' {
		order = binary.BigEndian
	}
	return values, binary.Read(rest, order, values)
}

// widened is the number with these 16 bits.
func widened(half uint16) float32 {
	power, part := int(half>>10&31), float64(half&1023)
	wide := math.Ldexp(part+1024, power-25)
	switch power {
	case 0:
		wide = math.Ldexp(part, -24)
	case 31:
		wide = math.Inf(1) * (1 - min(part, 1)) // Not a number where a part is left.
	}
	return float32(math.Copysign(wide, 0.5-float64(half>>15)))
}

// call extracts from samples that are stored as S and mean T.
func call[S any, T Sample](asked request, meaning func(S) T) (Mesh, error) {
	stored, err := samples[S](asked)
	values := make([]T, len(stored))
	for i, one := range stored {
		values[i] = meaning(one)
	}
	isovalue, finite := asked.Isovalues[0].(float64)
	if err == nil && !finite {
		err = fmt.Errorf("the isovalue is %v", asked.Isovalues[0])
	}
	if err != nil {
		return Mesh{}, err
	}
	return extract(values, [3]int(asked.Shape), isovalue, [3]float64(asked.Spacing))
}

// as extracts from samples that are what they are stored as.
func as[T Sample](asked request) (Mesh, error) {
	return call(asked, func(value T) T { return value })
}

// types has what to do with samples of each type.
var types = map[string]func(request) (Mesh, error){
	"b1": as[uint8], "u1": as[uint8], "u2": as[uint16], "u4": as[uint32], "u8": as[uint64],
	"i1": as[int8], "i2": as[int16], "i4": as[int32], "i8": as[int64], "f4": as[float32],
	"f8": as[float64], "f2": func(asked request) (Mesh, error) { return call(asked, widened) },
}

// answer is the mesh that is asked for.
func answer(asked request) (Mesh, error) {
	if len(asked.Shape) != 3 || len(asked.Isovalues) != 1 {
		return Mesh{}, fmt.Errorf("it takes one field with three axes")
	} else if extract, known := types[asked.Dtype[1:]]; known {
		return extract(asked)
	}
	return Mesh{}, fmt.Errorf("samples of an unknown type: %s", asked.Dtype)
}

// Serve answers every request with a line.
func Serve(declaration string) error {
	lines, answers := json.NewDecoder(os.Stdin), json.NewEncoder(os.NewFile(3, "descriptor 3 (see run)"))
	for {
		var asked request
		if err := lines.Decode(&asked); err == io.EOF || asked.Command == "stop" {
			return nil
		} else if err != nil {
			return err
		}
		said := map[string]any{"id": asked.ID}
		if asked.Command == "start" {
			said = map[string]any{"protocol": 3, "declaration": json.RawMessage(declaration)}
		} else if mesh, err := answer(asked); err != nil {
			said["error"] = err.Error()
		} else {
			said["vertices"] = append([][3]float64{}, mesh.Vertices...)
			said["simplices"] = append([][3]int{}, mesh.Triangles...)
		}
		if err := answers.Encode(said); err != nil { // A vertex is not finite, for one.
			if err = answers.Encode(map[string]any{"id": asked.ID, "error": err.Error()}); err != nil {
				return err
			}
		}
	}
}

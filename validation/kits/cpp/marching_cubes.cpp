/* Marching cubes in C++, the example of the kit: put your own extractor in its place.
 *
 * A sample is inside where it is at least the isovalue. Each pattern of inside corners has its
 * triangles in TRIANGLES (table.hpp), which cuts the inside corners of an ambiguous face apart, on
 * every face alike: so the surface is closed. A vertex belongs to a lattice edge, named by the
 * sample at its lower end and its axis, and is made by the first cell that asks for it. */
#include "isograde.hpp"
#include "table.hpp"

/* Where between two samples, one inside, the line through both takes the isovalue: 0 to 1. Low and
 * high are the samples minus the isovalue. */
double crossing(double low, double high) {
    return low == 0 ? 0 : 1 / (1 - high / low);
}

template <class T>
isograde::Mesh extract(const std::vector<T> &values, const isograde::Shape &shape, double isovalue,
                       const isograde::Point &spacing) {
    if (values.empty()) throw std::runtime_error("there are no samples");
    for (const T value : values)
        if (!std::isfinite(isograde::number(value) - isovalue))
            throw std::runtime_error("a sample minus the isovalue is no finite number");

    isograde::Mesh mesh;
    const isograde::Shape stride{shape[1] * shape[2], shape[2], 1};
    /* The vertex on each lattice edge, counted from 1; 0 where there is none. */
    std::vector<std::size_t> vertex(3 * values.size());
    isograde::Shape cell;
    for (cell[0] = 0; cell[0] + 1 < shape[0]; cell[0]++)
        for (cell[1] = 0; cell[1] + 1 < shape[1]; cell[1]++)
            for (cell[2] = 0; cell[2] + 1 < shape[2]; cell[2]++) {
                /* Read the samples at the corners; bit a of c is a step along axis a. */
                std::array<std::size_t, 8> corner{};
                std::array<double, 8> level;
                int signs = 0;
                for (int c = 0; c < 8; c++) {
                    for (int a = 0; a < 3; a++) corner[c] += (cell[a] + (c >> a & 1)) * stride[a];
                    level[c] = isograde::number(values[corner[c]]) - isovalue;
                    signs |= (level[c] >= 0) << c;
                }

                /* Copy the triangles of these signs; make the vertices that are not there yet. */
                for (const char *letter = TRIANGLES[signs]; *letter; letter += 3) {
                    std::array<std::size_t, 3> triangle;
                    for (int k = 0; k < 3; k++) {
                        const int edge = letter[k] - 'a', axis = edge / 4;
                        const int low = LOWER[edge], high = low | 1 << axis;
                        auto &name = vertex[3 * corner[low] + axis];
                        if (!name) {
                            isograde::Point at;
                            for (int a = 0; a < 3; a++) at[a] = double(cell[a] + (low >> a & 1));
                            at[axis] += crossing(level[low], level[high]);
                            for (int a = 0; a < 3; a++) at[a] *= spacing[a];
                            mesh.vertices.push_back(at);
                            name = mesh.vertices.size();
                        }
                        triangle[k] = name - 1;
                    }
                    mesh.triangles.push_back(triangle);
                }
            }
    return mesh;
}

int main() {
    return isograde::serve(R"({"name": "marching cubes in C++", "version": "1"})",
                           [](auto &...all) { return extract(all...); });
}

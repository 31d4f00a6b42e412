import java.io.IOException;
import java.util.ArrayList;
import java.util.List;

/**
 * Marching cubes in Java, the example of the kit: put your own extractor in its place.
 *
 * <p>A sample is inside where it is at least the isovalue. Each pattern of inside corners has its
 * triangles in {@link Table#TRIANGLES}, which cuts the inside corners of an ambiguous face apart,
 * on every face alike: so the surface is closed. A vertex belongs to a lattice edge, named by the
 * sample at its lower end and its axis, and is made by the first cell that asks for it.
 */
final class MarchingCubes {
    /**
     * Where between two samples, one inside, the line through both takes the isovalue: 0 to 1. Low
     * and high are the samples minus the isovalue.
     */
    private static double crossing(double low, double high) {
        return low == 0 ? 0 : 1 / (1 - high / low);
    }

    private static Isograde.Mesh extract(
            Isograde.Values values, int[] shape, double isovalue, double[] spacing) {
        if (values.length() == 0) throw new IllegalArgumentException("there are no samples");
        for (int i = 0; i < values.length(); i++) {
            if (!Double.isFinite(values.at(i) - isovalue)) {
                throw new ArithmeticException("a sample minus the isovalue is no finite number");
            }
        }

        List<double[]> vertices = new ArrayList<>();
        List<int[]> triangles = new ArrayList<>();
        int[] stride = {shape[1] * shape[2], shape[2], 1};
        // The vertex on each lattice edge, counted from 1; 0 where there is none.
        int[] vertex = new int[3 * values.length()];
        int[] cell = new int[3];
        for (cell[0] = 0; cell[0] + 1 < shape[0]; cell[0]++) {
            for (cell[1] = 0; cell[1] + 1 < shape[1]; cell[1]++) {
                for (cell[2] = 0; cell[2] + 1 < shape[2]; cell[2]++) {
                    // Read the samples at the corners; bit a of c is a step along axis a.
                    int[] corner = new int[8];
                    double[] level = new double[8];
                    int signs = 0;
                    for (int c = 0; c < 8; c++) {
                        for (int a = 0; a < 3; a++) {
                            corner[c] += (cell[a] + (c >> a & 1)) * stride[a];
                        }
                        level[c] = values.at(corner[c]) - isovalue;
                        if (level[c] >= 0) signs |= 1 << c;
                    }

                    // Copy the triangles of these signs; make the vertices that are not there yet.
                    String letters = Table.TRIANGLES[signs];
                    for (int start = 0; start < letters.length(); start += 3) {
                        int[] triangle = new int[3];
                        for (int k = 0; k < 3; k++) {
                            int edge = letters.charAt(start + k) - 'a', axis = edge / 4;
                            int low = Table.LOWER[edge], name = 3 * corner[low] + axis;
                            if (vertex[name] == 0) {
                                double[] at = new double[3];
                                for (int a = 0; a < 3; a++) at[a] = cell[a] + (low >> a & 1);
                                at[axis] += crossing(level[low], level[low | 1 << axis]);
                                for (int a = 0; a < 3; a++) at[a] *= spacing[a];
                                vertices.add(at);
                                vertex[name] = vertices.size();
                            }
                            triangle[k] = vertex[name] - 1;
                        }
                        triangles.add(triangle);
                    }
                }
            }
        }
        return new Isograde.Mesh(vertices, triangles);
    }

    public static void main(String[] arguments) throws IOException {
        Isograde.serve("{\"name\": \"marching cubes in Java\", \"version\": \"1\"}",
                MarchingCubes::extract);
    }
}

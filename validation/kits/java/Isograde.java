import static java.nio.charset.StandardCharsets.UTF_8;

import java.io.BufferedReader;
import java.io.FileOutputStream;
import java.io.IOException;
import java.io.InputStreamReader;
import java.io.PrintStream;
import java.nio.ByteBuffer;
import java.nio.ByteOrder;
import java.nio.file.Files;
import java.nio.file.Path;
import java.util.Arrays;
import java.util.List;
import java.util.stream.Collectors;
import java.util.stream.Stream;

/**
 * Lets isograde grade a program in Java, 17 or later.
 *
 * <p>{@link #serve} reads requests from standard input until there are no more, calls the extractor
 * for each, and answers. The declaration is JSON ({@code isograde explain declaration}). Answers go
 * to descriptor 3, so that whoever prints does no harm: {@code run} sees to it.
 */
final class Isograde {
    /** From samples in C order, the last axis fastest, to a mesh; throws what is wrong. */
    interface Extract {
        Mesh extract(Values values, int[] shape, double isovalue, double[] spacing);
    }

    /**
     * Vertices are index * spacing; triangles are three vertices each, counted from 0,
     * counterclockwise seen from where values are low.
     */
    record Mesh(List<double[]> vertices, List<int[]> triangles) {}

    /** Samples of a type that NumPy calls b1, u1, i2, f4, ..; bytes in the order of the buffer. */
    record Values(String type, int length, ByteBuffer buffer) {
        /**
         * Sample i as a double. A 64-bit integer that no double holds is rounded down, so that the
         * double is at least the isovalue exactly where the sample is.
         */
        double at(int i) {
            return switch (type) {
                case "b1", "u1" -> Byte.toUnsignedInt(buffer.get(i));
                case "u2" -> Short.toUnsignedInt(buffer.getShort(2 * i));
                case "u4" -> Integer.toUnsignedLong(buffer.getInt(4 * i));
                case "u8" -> unsigned(buffer.getLong(8 * i));
                case "i1" -> buffer.get(i);
                case "i2" -> buffer.getShort(2 * i);
                case "i4" -> buffer.getInt(4 * i);
                case "i8" -> signed(buffer.getLong(8 * i));
                case "f2" -> half(buffer.getShort(2 * i));
                case "f4" -> buffer.getFloat(4 * i);
                case "f8" -> buffer.getDouble(8 * i);
                default -> throw new IllegalArgumentException("samples of unknown type " + type);
            };
        }

        private static double signed(long whole) {
            double wide = whole;
            return wide >= 0x1p63 || (long) wide > whole ? Math.nextDown(wide) : wide;
        }

        private static double unsigned(long whole) {
            return whole >= 0 ? signed(whole) : (whole >>> 11) * 0x1p11;
        }

        private static double half(short bits) {
            int power = bits >> 10 & 31, part = bits & 1023;
            double wide = Math.scalb(power == 0 ? part : part + 1024.0, Math.max(power, 1) - 25);
            if (power == 31) wide = part == 0 ? Double.POSITIVE_INFINITY : Double.NaN;
            return bits < 0 ? -wide : wide;
        }
    }

    /** What a request, a line of JSON, says under a key, without quotes or brackets. */
    private static String said(String line, String key) {
        int start = line.indexOf('"' + key + "\": ") + key.length() + 4;
        char first = line.charAt(start);
        String ends = first == '"' ? "\"" : first == '[' ? "]" : ",}";
        start += ends.length() == 1 ? 1 : 0;
        int end = start;
        while (ends.indexOf(line.charAt(end)) < 0) end++;
        return line.substring(start, end);
    }

    /** So many numbers of a list, NaN where JSON has none. */
    private static double[] list(String line, String key, int count) {
        String[] parts = said(line, key).split(", ");
        if (parts.length != count) {
            throw new IllegalArgumentException("it takes one field with three axes");
        }
        double[] numbers = new double[count];
        for (int i = 0; i < count; i++) {
            numbers[i] = Double.parseDouble(parts[i].replace("\"", "")); // "NaN" and "Infinity" too.
        }
        return numbers;
    }

    /** The mesh that a request asks for. */
    private static Mesh answer(String line, Extract extractor) throws IOException {
        double[] lengths = list(line, "shape", 3), spacing = list(line, "spacing", 3);
        int[] shape = Arrays.stream(lengths).mapToInt(length -> (int) length).toArray();
        String type = said(line, "dtype");
        int length = shape[0] * shape[1] * shape[2];
        int offset = Integer.parseInt(said(line, "offset"));
        ByteBuffer bytes = ByteBuffer.wrap(Files.readAllBytes(Path.of(said(line, "values"))));
        ByteBuffer samples = bytes.slice(offset, bytes.capacity() - offset);
        samples.order(type.charAt(0) == '>' ? ByteOrder.BIG_ENDIAN : ByteOrder.LITTLE_ENDIAN);
        Values values = new Values(type.substring(1), length, samples);
        return extractor.extract(values, shape, list(line, "isovalues", 1)[0], spacing);
    }

    /** Rows as JSON, null for what is not finite. */
    private static String rows(Stream<String> rows) {
        String text = rows.collect(Collectors.joining(", ", "[", "]"));
        return text.replaceAll("-?Infinity|NaN", "null");
    }

    /** Answers every request with a line. */
    static void serve(String declaration, Extract extractor) throws IOException {
        PrintStream answers = new PrintStream(new FileOutputStream("/dev/fd/3", true), false, UTF_8);
        BufferedReader lines = new BufferedReader(new InputStreamReader(System.in, UTF_8));
        for (String line; (line = lines.readLine()) != null; answers.flush()) {
            if (said(line, "command").equals("stop")) break;
            if (said(line, "command").equals("start")) {
                answers.println("{\"protocol\": 3, \"declaration\": " + declaration + "}");
                continue;
            }
            answers.print("{\"id\": " + said(line, "id"));
            try {
                Mesh mesh = answer(line, extractor);
                String points = rows(mesh.vertices().stream().map(Arrays::toString));
                String corners = rows(mesh.triangles().stream().map(Arrays::toString));
                answers.println(", \"vertices\": " + points + ", \"simplices\": " + corners + "}");
            } catch (IOException | RuntimeException error) {
                String wrong = error.toString().replaceAll("[\"\\\\\n]", "'");
                answers.println(", \"error\": \"" + wrong + "\"}");
            }
        }
    }
}

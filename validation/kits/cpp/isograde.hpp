/* isograde.hpp: lets isograde grade a program in C++ (17 or later). With a function template
 *
 *     template <class T>
 *     isograde::Mesh extract(const std::vector<T> &values, const isograde::Shape &shape,
 *                            double isovalue, const isograde::Point &spacing);
 *
 * `main` returns isograde::serve("{\"name\": \"me\"}", [](auto &...all) { return extract(all...); })
 * which reads requests from standard input until there are no more, calls `extract` for each, and
 * answers. Samples keep their type, but float16 comes as float, and bool as bytes. `extract` throws
 * what is wrong. Answers go to descriptor 3, so that whoever prints does no harm: `run` sees to it.
 * For POSIX systems, little-endian. */
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <iostream>
#include <sstream>
#include <vector>
namespace isograde {
using Shape = std::array<std::size_t, 3>;
using Point = std::array<double, 3>;
/* Vertices are index * spacing; triangles are three vertices each, counted from 0, counterclockwise
 * seen from where values are low. */
struct Mesh {
    std::vector<Point> vertices;
    std::vector<std::array<std::size_t, 3>> triangles;
};

/* A sample as a double. A 64-bit integer that no double holds is rounded down, so that the double
 * is at least the isovalue exactly where the sample is. */
template <class T> double number(T value) {
    const double wide = double(value);
    if constexpr (std::is_integral_v<T> && sizeof(T) == 8)
        if (wide >= std::ldexp(1.0, 8 * sizeof(T) - std::is_signed_v<T>) || T(wide) > value)
            return std::nextafter(wide, -INFINITY);
    return wide;
}

/* What a request, a line of JSON, says under a key, without quotes or brackets. */
inline std::string said(const std::string &line, const std::string &key) {
    auto start = line.find('"' + key + "\": ");
    if (start == std::string::npos) throw std::runtime_error("the request has no " + key);
    start += key.size() + 4;
    const char *end = line[start] == '"' ? "\"" : line[start] == '[' ? "]" : ",}";
    start += *end != ',';
    return line.substr(start, line.find_first_of(end, start) - start);
}

/* The numbers of a list, texts such as "Infinity" among them. */
template <std::size_t count>
std::array<double, count> list(const std::string &line, const std::string &key) {
    const auto text = said(line, key);
    if (std::count(text.begin(), text.end(), ',') + 1 != count)
        throw std::runtime_error("it takes one field with three axes");
    std::array<double, count> numbers;
    const char *at = text.c_str();
    for (auto &one : numbers) {
        char *end;
        one = std::strtod(at += std::strspn(at, " \""), &end), one = end == at ? NAN : one;
        at += std::strcspn(at, ",") + 1;
    }
    return numbers;
}

/* The samples of a request, in this type. */
template <class T> std::vector<T> samples(const std::string &line, std::size_t count) {
    std::vector<T> values(count);
    std::ifstream file(said(line, "values"), std::ios::binary);
    file.seekg(std::stol(said(line, "offset")));
    const auto bytes = reinterpret_cast<char *>(values.data());
    if (!file.read(bytes, count * sizeof(T)))
        throw std::runtime_error("the file of samples cannot be read");
    if (said(line, "dtype")[0] == '>')
        for (auto at = bytes; at < bytes + count * sizeof(T); at += sizeof(T))
            std::reverse(at, at + sizeof(T));
    return values;
}

/* Numbers of 16 bits as floats. */
inline std::vector<float> widened(const std::vector<std::uint16_t> &halves) {
    std::vector<float> values;
    for (const int half : halves) {
        const int power = half >> 10 & 31, part = half & 1023;
        const float wide = power == 31 ? (part ? NAN : INFINITY)
            : std::ldexp(float(power ? part + 1024 : part), (power ? power : 1) - 25);
        values.push_back(half >> 15 ? -wide : wide);
    }
    return values;
}

/* The mesh that a request asks for. */
template <class Extract> Mesh answer(const std::string &line, Extract extract) {
    const auto n = list<3>(line, "shape"), spacing = list<3>(line, "spacing");
    const Shape shape{std::size_t(n[0]), std::size_t(n[1]), std::size_t(n[2])};
    const auto count = shape[0] * shape[1] * shape[2];
    const auto isovalue = list<1>(line, "isovalues")[0];
    const auto call = [&](const auto &values) { return extract(values, shape, isovalue, spacing); };
    const auto type = said(line, "dtype").substr(1);
    if (type == "b1" || type == "u1") return call(samples<std::uint8_t>(line, count));
    if (type == "u2") return call(samples<std::uint16_t>(line, count));
    if (type == "u4") return call(samples<std::uint32_t>(line, count));
    if (type == "u8") return call(samples<std::uint64_t>(line, count));
    if (type == "i1") return call(samples<std::int8_t>(line, count));
    if (type == "i2") return call(samples<std::int16_t>(line, count));
    if (type == "i4") return call(samples<std::int32_t>(line, count));
    if (type == "i8") return call(samples<std::int64_t>(line, count));
    if (type == "f2") return call(widened(samples<std::uint16_t>(line, count)));
    if (type == "f4") return call(samples<float>(line, count));
    if (type == "f8") return call(samples<double>(line, count));
    throw std::runtime_error("samples of an unknown type: " + type);
}

/* Rows of three numbers as JSON, null for what is not finite. */
template <class Row> void write(std::ostream &out, const char *name, const std::vector<Row> &rows) {
    out << ", \"" << name << "\": [";
    for (std::size_t i = 0; i < 3 * rows.size(); i++) {
        const auto number = rows[i / 3][i % 3];
        out << (i % 3 ? ", " : i ? "], [" : "[");
        std::isfinite(double(number)) ? out << number : out << "null";
    }
    out << (rows.empty() ? "]" : "]]");
}

/* Every request answered with a line; the status for `main`. */
template <class Extract> int serve(const char *declaration, Extract extract) {
    std::FILE *answers = fdopen(3, "w");
    if (!answers) std::cerr << "answers go to descriptor 3: run it with 3>&1 1>&2\n";
    for (std::string line; answers && std::getline(std::cin, line);) {
        std::ostringstream out;
        out.precision(17);
        if (said(line, "command") == "stop") break;
        if (said(line, "command") == "start") {
            out << "{\"protocol\": 3, \"declaration\": " << declaration;
        } else try {
            const Mesh mesh = answer(line, extract);
            out << "{\"id\": " << said(line, "id");
            write(out, "vertices", mesh.vertices), write(out, "simplices", mesh.triangles);
        } catch (const std::exception &error) {
            std::string wrong = error.what();
            for (char &c : wrong) c = c == '"' || c == '\\' || c == '\n' ? '\'' : c;
            out << "{\"id\": " << said(line, "id") << ", \"error\": \"" << wrong << '"';
        }
        std::fputs((out.str() + "}\n").c_str(), answers), std::fflush(answers);
    }
    return !answers;
}
}

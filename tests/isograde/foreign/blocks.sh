#!/bin/sh
# The faces between inside and outside samples, as squares: a shell pipeline.
# od turns the samples into text, awk makes the faces, and the answer is an .off file.
entry() { printf '%s\n' "$line" | sed "s/.*\"$1\": *\(\"[^\"]*\"\|\[[^]]*\]\|[^,}]*\).*/\1/" | tr -d '[]",'; }

while read -r line; do
    case $line in
    *'"start"'*)
        echo '{"protocol": 3, "declaration": {"name": "blocks", "level": 1,
            "interpolant": "labels", "conventions": {"nan": "answers"}, "vertices": "cells", "mesh": {"soup": 1e-6},
            "domain": {"inset": -0.5, "end": "open"}, "limits": {"types": ["float64"]}}}' |
            tr -d '\n'
        echo ;;
    *'"stop"'*) exit ;;
    *'"dtype": "<f8"'*)
        od -A n -v -t f8 -w8 -j "$(entry offset)" "$(entry values)" |
            awk -v shape="$(entry shape)" -v spacing="$(entry spacing)" -v isovalue="$(entry isovalues)" '
                function corner(a, u, b, v, c, w) {
                    p[a] = u; p[b] = v; p[c] = w
                    points = points p[1] * h[1] " " p[2] * h[2] " " p[3] * h[3] "\n"
                }
                function square(a, at, b, c, up,   i, s) {
                    for (i = 0; i < 4; i++) {
                        s = up ? i : 3 - i
                        corner(a, at, b, q[b] + (s == 1 || s == 2) - 0.5, c, q[c] + (s > 1) - 0.5)
                    }
                    faces = faces "4 " V " " V + 1 " " V + 2 " " V + 3 "\n"
                    V += 4; S++
                }
                BEGIN { split(shape, n, " "); split(spacing, h, " "); isovalue += 0; V = 0; S = 0 }
                { inside[NR - 1] = $1 >= isovalue }
                END {
                    stride[3] = 1; stride[2] = n[3]; stride[1] = n[2] * n[3]
                    for (at = 0; at < NR; at++) {
                        q[1] = int(at / stride[1]); q[2] = int(at / stride[2]) % n[2]; q[3] = at % n[3]
                        for (a = 1; a <= 3; a++)
                            if (q[a] + 1 < n[a] && inside[at] != inside[at + stride[a]])
                                square(a, q[a] + 0.5, a % 3 + 1, (a + 1) % 3 + 1, inside[at])
                    }
                    printf "OFF\n%d %d 0\n%s%s", V, S, points, faces
                }' > "$(entry directory)/mesh.off"
        echo "{\"id\": $(entry id), \"mesh\": \"mesh.off\"}" ;;
    *) echo "{\"id\": $(entry id), \"error\": \"was sent what it does not read\"}" ;;
    esac
done

"""Exercise 4: marching cubes as it was drawn in 1987. Something in it is wrong.

Read lesson 4, mend this file, and ask: isograde exercise 4 exercise_4.py
"""

import numpy as np

declaration = {"name": "exercise 4"}

# Edge e of a cell runs along axis e // 4 from corner LOWER[e]; corner c stands one step along
# axis a where bit a of c is set. TRIANGLES[signs], where bit c of signs says that corner c is
# inside, has three letters a triangle, a for edge 0 to l for edge 11.
LOWER = [0, 2, 4, 6, 0, 1, 4, 5, 0, 1, 2, 3]
# fmt: off
TRIANGLES = [
    "", "aei", "ajf", "eijejf", "bke", "abkaki", "ajfbke", "bkibijbjf", "bfl", "aeibfl", "ajlalb",
    "beibijbjl", "eflelk", "aflalkaki", "ajlalkake", "ijlilk", "cig", "aegagc", "ajfcig",
    "cjfcfeceg", "bkecig", "abkakgagc", "ajfbkecig", "bkgbgcbcjbjf", "bflcig", "aegagcbfl",
    "ajlalbcig", "begbgcbcjbjl", "cigeflelk", "aflalkakgagc", "ajlalkakecig", "cjlclkckg", "chj",
    "aeichj", "achahf", "chfcfecei", "bkechj", "abkakichj", "achahfbke", "bkibicbchbhf", "bflchj",
    "aeibflchj", "achahlalb", "beibicbchbhl", "chjeflelk", "aflalkakichj", "achahlalkake",
    "chlclkcki", "ghjgji", "aegaghahj", "aigaghahf", "eghehf", "bkeghjgji", "abkakgaghahj",
    "aigaghahfbke", "bkgbghbhf", "bflghjgji", "aegaghahjbfl", "aigaghahlalb", "begbghbhl",
    "eflelkghjgji", "aflalkakgaghahj", "aigaghahlalkake", "ghlglk", "dgk", "aeidgk", "ajfdgk",
    "dgkeijejf", "bdgbge", "abdadgagi", "ajfbdgbge", "bdgbgibijbjf", "bfldgk", "aeibfldgk",
    "ajlalbdgk", "beibijbjldgk", "dgedefdfl", "aflaldadgagi", "ajlaldadgage", "dgidijdjl", "cikckd",
    "aekakdadc", "ajfcikckd", "cjfcfecekckd", "bdcbcibie", "abdadc", "ajfbdcbcibie", "bdcbcjbjf",
    "bflcikckd", "aekakdadcbfl", "ajlalbcikckd", "ekdedcecjejlelb", "ciecefcflcld", "aflaldadc",
    "ldclcilielealaj", "cjlcld", "chjdgk", "aeichjdgk", "achahfdgk", "chfcfeceidgk", "bdgbgechj",
    "abdadgagichj", "achahfbdgbge", "bdgbgibicbchbhf", "bflchjdgk", "aeibflchjdgk", "achahlalbdgk",
    "beibicbchbhldgk", "chjdgedefdfl", "aflaldadgagichj", "achahlaldadgage", "ldglgiliclch",
    "dhjdjidik", "aekakdadhahj", "aikakdadhahf", "dhfdfedek", "bdhbhjbjibie", "abdadhahj",
    "iebibdidhihfifa", "bdhbhf", "bfldhjdjidik", "aekakdadhahjbfl", "aikakdadhahlalb",
    "ekdedhehlelb", "dhjdjidiedefdfl", "aflaldadhahj", "aiedhl", "dhl", "dlh", "aeidlh", "ajfdlh",
    "dlheijejf", "bkedlh", "abkakidlh", "ajfbkedlh", "bkibijbjfdlh", "bfhbhd", "aeibfhbhd",
    "ajhahdadb", "beibijbjhbhd", "dkedefdfh", "afhahdadkaki", "ajhahdadkake", "dkidijdjh", "cigdlh",
    "aegagcdlh", "ajfcigdlh", "cjfcfecegdlh", "bkecigdlh", "abkakgagcdlh", "ajfbkecigdlh",
    "bkgbgcbcjbjfdlh", "bfhbhdcig", "aegagcbfhbhd", "ajhahdadbcig", "begbgcbcjbjhbhd",
    "cigdkedefdfh", "afhahdadkakgagc", "ajhahdadkakecig", "jhdjdkjkgjgc", "cdlclj", "aeicdlclj",
    "acdadlalf", "cdlclfcfecei", "bkecdlclj", "abkakicdlclj", "acdadlalfbke", "icdidlilfifbibk",
    "bfjbjcbcd", "aeibfjbjcbcd", "acdadb", "beibicbcd", "cdkckecefcfj", "fjcfcdfdkfkifia",
    "acdadkake", "cdkcki", "dljdjidig", "aegagdadlalj", "aigagdadlalf", "dlfdfedeg", "bkedljdjidig",
    "abkakgagdadlalj", "aigagdadlalfbke", "gdlglfgfbgbk", "bfjbjibigbgd", "gdbgbfgfjgjagae",
    "aigagdadb", "begbgd", "dkedefdfjdjidig", "afjdkg", "aigagdadkake", "dkg", "gklglh",
    "aeigklglh", "ajfgklglh", "eijejfgklglh", "blhbhgbge", "ablalhahgagi", "ajfblhbhgbge",
    "blhbhgbgibijbjf", "bfhbhgbgk", "aeibfhbhgbgk", "ajhahgagkakb", "beibijbjhbhgbgk", "efhehg",
    "afhahgagi", "ajhahgage", "gijgjh", "cikcklclh", "aekaklalhahc", "ajfcikcklclh",
    "cjfcfecekcklclh", "blhbhcbcibie", "ablalhahc", "ajfblhbhcbcibie", "blhbhcbcjbjf",
    "bfhbhcbcibik", "kbfkfhkhckcakae", "hcihikhkbhbahaj", "bekcjh", "ciecefcfh", "afhahc",
    "hcihieheahaj", "cjh", "cgkcklclj", "aeicgkcklclj", "acgagkaklalf", "cgkcklclfcfecei",
    "bljbjcbcgbge", "bljbjcbcgbgibia", "cgecebcblclfcfa", "blfcgi", "bfjbjcbcgbgk",
    "aeibfjbjcbcgbgk", "acgagkakb", "beibicbcgbgk", "cgecefcfj", "fjcfcgfgifia", "acgage", "cgi",
    "iklilj", "aekaklalj", "aikaklalf", "eklelf", "bljbjibie", "ablalj", "iebiblilfifa", "blf",
    "bfjbjibik", "kbfkfjkjakae", "aikakb", "bek", "efjeji", "afj", "aie", "",
]
# fmt: on


def row(signs):
    """The triangles of a pattern of inside corners, three edges each."""
    few = bin(signs).count("1") <= 4
    letters = TRIANGLES[signs] if few else TRIANGLES[255 - signs][::-1]
    numbers = [ord(letter) - ord("a") for letter in letters]
    return [numbers[k : k + 3] for k in range(0, len(numbers), 3)]


def extract(values, isovalue, spacing):
    """The triangles of all cells; a vertex belongs to a lattice edge, and is made once."""
    vertices, triangles, numbers = [], [], {}
    for cell in np.ndindex(*np.subtract(values.shape, 1)):
        corners = [tuple(cell[a] + (c >> a & 1) for a in range(3)) for c in range(8)]
        g = [float(values[corner]) - isovalue for corner in corners]
        signs = sum(1 << c for c in range(8) if g[c] >= 0)
        for edges in row(signs):
            triangle = []
            for edge in edges:
                low, high = LOWER[edge], LOWER[edge] | 1 << edge // 4
                name = corners[low], edge // 4
                if name not in numbers:
                    numbers[name] = len(vertices)
                    place = np.array(corners[low], float)
                    place[edge // 4] += g[low] / (g[low] - g[high])
                    vertices.append(place * spacing)
                triangle.append(numbers[name])
            triangles.append(triangle)
    return np.array(vertices).reshape(-1, 3), np.array(triangles, int).reshape(-1, 3)

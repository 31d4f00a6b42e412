// Written by tables.py of isograde's kits from isoref: not to be edited.
// Edge e of a cell runs along axis e / 4 from corner LOWER[e]; corner c stands one step along
// axis a where bit a of c is set. TRIANGLES[signs], where bit c of signs says that corner c is
// inside, has three letters a triangle, a for edge 0 to l for edge 11.
package main

var lower = [12]int{0, 2, 4, 6, 0, 1, 4, 5, 0, 1, 2, 3}

var triangles = [256]string{
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
	"ajlalbdgk", "beibijbjldgk", "dgedefdfl", "aflaldadgagi", "ajlaldadgage", "dgidijdjl",
	"cikckd", "aekakdadc", "ajfcikckd", "cjfcfecekckd", "bdcbcibie", "abdadc", "ajfbdcbcibie",
	"bdcbcjbjf", "bflcikckd", "aekakdadcbfl", "ajlalbcikckd", "ekdedcecjejlelb", "ciecefcflcld",
	"aflaldadc", "ldclcilielealaj", "cjlcld", "chjdgk", "aeichjdgk", "achahfdgk", "chfcfeceidgk",
	"bdgbgechj", "abdadgagichj", "achahfbdgbge", "bdgbgibicbchbhf", "bflchjdgk", "aeibflchjdgk",
	"achahlalbdgk", "beibicbchbhldgk", "chjdgedefdfl", "aflaldadgagichj", "achahlaldadgage",
	"ldglgiliclch", "dhjdjidik", "aekakdadhahj", "aikakdadhahf", "dhfdfedek", "bdhbhjbjibie",
	"abdadhahj", "iebibdidhihfifa", "bdhbhf", "bfldhjdjidik", "aekakdadhahjbfl",
	"aikakdadhahlalb", "ekdedhehlelb", "dhjdjidiedefdfl", "aflaldadhahj", "aiedhl", "dhl", "dlh",
	"aeidlh", "ajfdlh", "dlheijejf", "bkedlh", "abkakidlh", "ajfbkedlh", "bkibijbjfdlh", "bfhbhd",
	"aeibfhbhd", "ajhahdadb", "beibijbjhbhd", "dkedefdfh", "afhahdadkaki", "ajhahdadkake",
	"dkidijdjh", "cigdlh", "aegagcdlh", "ajfcigdlh", "cjfcfecegdlh", "bkecigdlh", "abkakgagcdlh",
	"ajfbkecigdlh", "bkgbgcbcjbjfdlh", "bfhbhdcig", "aegagcbfhbhd", "ajhahdadbcig",
	"begbgcbcjbjhbhd", "cigdkedefdfh", "afhahdadkakgagc", "ajhahdadkakecig", "jhdjdkjkgjgc",
	"cdlclj", "aeicdlclj", "acdadlalf", "cdlclfcfecei", "bkecdlclj", "abkakicdlclj",
	"acdadlalfbke", "icdidlilfifbibk", "bfjbjcbcd", "aeibfjbjcbcd", "acdadb", "beibicbcd",
	"cdkckecefcfj", "fjcfcdfdkfkifia", "acdadkake", "cdkcki", "dljdjidig", "aegagdadlalj",
	"aigagdadlalf", "dlfdfedeg", "bkedljdjidig", "abkakgagdadlalj", "aigagdadlalfbke",
	"gdlglfgfbgbk", "bfjbjibigbgd", "gdbgbfgfjgjagae", "aigagdadb", "begbgd", "dkedefdfjdjidig",
	"afjdkg", "aigagdadkake", "dkg", "gklglh", "aeigklglh", "ajfgklglh", "eijejfgklglh",
	"blhbhgbge", "ablalhahgagi", "ajfblhbhgbge", "blhbhgbgibijbjf", "bfhbhgbgk", "aeibfhbhgbgk",
	"ajhahgagkakb", "beibijbjhbhgbgk", "efhehg", "afhahgagi", "ajhahgage", "gijgjh", "cikcklclh",
	"aekaklalhahc", "ajfcikcklclh", "cjfcfecekcklclh", "blhbhcbcibie", "ablalhahc",
	"ajfblhbhcbcibie", "blhbhcbcjbjf", "bfhbhcbcibik", "kbfkfhkhckcakae", "hcihikhkbhbahaj",
	"bekcjh", "ciecefcfh", "afhahc", "hcihieheahaj", "cjh", "cgkcklclj", "aeicgkcklclj",
	"acgagkaklalf", "cgkcklclfcfecei", "bljbjcbcgbge", "bljbjcbcgbgibia", "cgecebcblclfcfa",
	"blfcgi", "bfjbjcbcgbgk", "aeibfjbjcbcgbgk", "acgagkakb", "beibicbcgbgk", "cgecefcfj",
	"fjcfcgfgifia", "acgage", "cgi", "iklilj", "aekaklalj", "aikaklalf", "eklelf", "bljbjibie",
	"ablalj", "iebiblilfifa", "blf", "bfjbjibik", "kbfkfjkjakae", "aikakb", "bek", "efjeji",
	"afj", "aie", "",
}

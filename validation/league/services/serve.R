# Answers the grader for one method of an R package: `Rscript serve.R METHOD.json`, beside `adapter.R`
# and with jsonlite. METHOD.json has the `function` of the adapter and the `declaration`. R has no
# 64-bit integers, no 32-bit unsigned ones and no short floats: the declaration leaves them out.
suppressPackageStartupMessages(library(jsonlite))

method_file <- commandArgs(trailingOnly = TRUE)[1]
method <- read_json(method_file)
source("adapter.R")
extract <- get(method$`function`)

# The samples of a request, as an array whose axes are those of the request.
samples <- function(asked) {
  kind <- substr(asked$dtype, 2, 2)
  size <- as.integer(substring(asked$dtype, 3))
  if (kind == "b") kind <- "u"
  count <- prod(asked$shape)
  file <- file(asked$values, "rb")
  on.exit(close(file))
  readBin(file, "raw", asked$offset)
  what <- if (kind == "f") "double" else "integer"
  values <- readBin(file, what, count, size = size, signed = kind != "u" || size > 2,
                    endian = if (substr(asked$dtype, 1, 1) == ">") "big" else "little")
  # The last axis is fastest in the file, the first in R.
  aperm(array(as.double(values), rev(asked$shape)), 3:1)
}

# Kilobytes of this process, as Linux counts them; 0 elsewhere.
memory <- function(name) {
  lines <- tryCatch(readLines("/proc/self/status"), error = function(e) "")
  line <- grep(paste0("^", name), lines, value = TRUE)
  if (length(line)) as.numeric(gsub("[^0-9]", "", line)) else 0
}

# What a call gives; what it costs is a line of the file that ISOGRADE_COST names.
costed <- function(call) {
  path <- Sys.getenv("ISOGRADE_COST")
  if (path == "") return(call)
  before <- memory("VmRSS:")
  try(cat("5", file = "/proc/self/clear_refs"), silent = TRUE)
  used <- system.time(found <- call, gcFirst = FALSE)
  more <- memory("VmHWM:") - before
  cat(used[["elapsed"]], used[["user.self"]] + used[["sys.self"]], more, "\n", file = path, append = TRUE)
  found
}

answer <- function(asked) {
  tryCatch({
    isovalue <- as.double(asked$isovalues[[1]])
    values <- samples(asked)
    mesh <- costed(extract(values, isovalue, asked$spacing))
    list(id = asked$id, vertices = mesh$vertices, simplices = mesh$triangles)
  }, error = function(wrong) list(id = asked$id, error = conditionMessage(wrong)))
}

say <- function(said) {
  cat(toJSON(said, auto_unbox = TRUE, digits = NA, matrix = "rowmajor", na = "null"), "\n", sep = "")
}

input <- file("stdin", "r")
while (length(line <- readLines(input, 1)) > 0) {
  asked <- fromJSON(line)
  if (asked$command == "stop") break
  if (asked$command == "start") {
    # The declaration goes through as it is written: R would turn its lists into something else.
    text <- paste(readLines(method_file, warn = FALSE), collapse = "")
    declared <- sub('^.*"declaration": *(\\{.*\\}) *\\}$', "\\1", text)
    cat('{"protocol": 3, "declaration": ', declared, "}\n", sep = "")
  } else {
    say(answer(asked))
  }
  flush(stdout())
}

% Answers the grader for one method in Octave: `octave-cli serve.m METHOD.json`, beside `adapter.m`.
% METHOD.json has the `declaration`; `adapter` is the function.
1;

function values = samples (asked)
  % The samples of a request as an array whose axes are those of the request.
  types = struct ("b1", "uint8", "u1", "uint8", "u2", "uint16", "u4", "uint32", "u8", "uint64", ...
                  "i1", "int8", "i2", "int16", "i4", "int32", "i8", "int64", ...
                  "f2", "uint16", "f4", "single", "f8", "double");
  order = "ieee-le";
  if (asked.dtype(1) == ">")
    order = "ieee-be";
  endif
  file = fopen (asked.values, "r", order);
  fseek (file, asked.offset, SEEK_SET);
  values = fread (file, prod (asked.shape), ["*" types.(asked.dtype(2:3))], 0, order);
  fclose (file);
  if (strcmp (asked.dtype(2:3), "f2"))
    values = halves (values);
  endif
  % The last axis is fastest in the file, the first in Octave.
  values = permute (reshape (values, fliplr (asked.shape(:)')), [3 2 1]);
endfunction

function values = halves (bits)
  % Numbers of half precision, a type that Octave lacks, from their bits: in single precision.
  bits = double (bits);
  exponent = mod (floor (bits / 1024), 32);
  fraction = mod (bits, 1024) / 1024;
  values = (fraction + (exponent > 0)) .* 2 .^ (max (exponent, 1) - 15);
  values(exponent == 31) = Inf;
  values(exponent == 31 & fraction > 0) = NaN;
  values = single (values .* (1 - 2 * (bits >= 32768)));
endfunction

function line = rows_of (numbers, form)
  % A matrix as JSON, row by row.
  if (isempty (numbers))
    line = "[]";
    return;
  endif
  row = ["[" form ", " form ", " form "], "];
  line = sprintf (row, numbers');
  line = ["[" line(1:end-2) "]"];
  line = strrep (strrep (strrep (line, "-Inf", "null"), "Inf", "null"), "NaN", "null");
endfunction

function kilobytes = memory_of (name)
  % Kilobytes of this process, as Linux counts them; 0 elsewhere.
  kilobytes = 0;
  file = fopen ("/proc/self/status", "r");
  if (file >= 0)
    found = regexp (fread (file, [1 Inf], "*char"), [name '\s*(\d+)'], "tokens", "once");
    fclose (file);
    kilobytes = str2double (found{1});
  endif
endfunction

function now = cost (before)
  % The moment before a call; after it, its cost as a line of the file that ISOGRADE_COST names.
  path = getenv ("ISOGRADE_COST");
  if (isempty (path))
    now = [];
  elseif (nargin == 0)
    kilobytes = memory_of ("VmRSS:");
    file = fopen ("/proc/self/clear_refs", "w");
    if (file >= 0)
      fputs (file, "5");
      fclose (file);
    endif
    now = [time(), cputime(), kilobytes];
  else
    now = [time(), cputime(), memory_of("VmHWM:")] - before;
    file = fopen (path, "a");
    fprintf (file, "%.9g %.9g %d\n", now);
    fclose (file);
  endif
endfunction

method = jsondecode (fileread (argv (){end}));
text = fileread (argv (){end});
declared = regexprep (text, '^.*"declaration":\s*(\{.*\})\s*\}\s*$', '$1');
declared = strrep (declared, "\n", " ");
while (true)
  % fgetl would wait for more than a line.
  asked = jsondecode (input ("", "s"));
  if (strcmp (asked.command, "stop"))
    break;
  elseif (strcmp (asked.command, "start"))
    printf ('{"protocol": 3, "declaration": %s}\n', declared);
  else
    try
      isovalue = NaN;
      if (isnumeric (asked.isovalues) && ! isempty (asked.isovalues))
        isovalue = asked.isovalues(1);
      endif
      values = samples (asked);
      before = cost ();
      [vertices, triangles] = adapter (values, isovalue, asked.spacing(:)');
      cost (before);
      printf ('{"id": %d, "vertices": %s, "simplices": %s}\n', asked.id, ...
              rows_of (double (vertices), "%.17g"), rows_of (double (triangles) - 1, "%d"));
    catch wrong
      printf ('{"id": %d, "error": %s}\n', asked.id, jsonencode (wrong.message));
    end_try_catch
  endif
  fflush (stdout);
endwhile

% Answers the grader for one method in Octave: `octave-cli serve.m METHOD.json`, beside `adapter.m`.
% METHOD.json has the `declaration`; `adapter` is the function.
1;

function values = samples (asked)
  % The samples of a request as an array whose axes are those of the request.
  types = struct ("b1", "uint8", "u1", "uint8", "u2", "uint16", "u4", "uint32", "u8", "uint64", ...
                  "i1", "int8", "i2", "int16", "i4", "int32", "i8", "int64", ...
                  "f4", "single", "f8", "double");
  order = "ieee-le";
  if (asked.dtype(1) == ">")
    order = "ieee-be";
  endif
  file = fopen (asked.values, "r", order);
  fseek (file, asked.offset, SEEK_SET);
  values = fread (file, prod (asked.shape), ["*" types.(asked.dtype(2:3))], 0, order);
  fclose (file);
  % The last axis is fastest in the file, the first in Octave.
  values = permute (reshape (values, fliplr (asked.shape(:)')), [3 2 1]);
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
      [vertices, triangles] = adapter (samples (asked), isovalue, asked.spacing(:)');
      printf ('{"id": %d, "vertices": %s, "simplices": %s}\n', asked.id, ...
              rows_of (double (vertices), "%.17g"), rows_of (double (triangles) - 1, "%d"));
    catch wrong
      printf ('{"id": %d, "error": %s}\n', asked.id, jsonencode (wrong.message));
    end_try_catch
  endif
  fflush (stdout);
endwhile

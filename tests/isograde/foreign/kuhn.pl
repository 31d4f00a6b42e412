#!/usr/bin/perl
# Contours and curves by Kuhn's simplices: each cell is cut along its main diagonal, and the one or
# two fields are linear on each piece.
#
#   perl kuhn.pl polylines            speaks the protocol of exec: on standard input
#   perl kuhn.pl polylines FOLDER     answers every field of an exported folder, for dir:
#   perl kuhn.pl segments ..          the same, with the answer as an indexed mesh
use strict;
use warnings;
use JSON::PP;

my ($form, $folder) = @ARGV;
my $declaration = {name => "Kuhn in Perl", interpolant => "kuhn", conventions => {nan => "answers"},
                   limits => {kinds => [[2, 1], [3, 2]], types => ["float64", "int64", "uint8"]}};
my (@shape, @step, @f, @paths, $m, $n);    # f: a list of samples a component, isovalue subtracted
my (%at, @links);                          # the point on a face, by its key; pairs of keys

sub slurp { open my $file, '<:raw', $_[0] or die "$_[0]: $!\n"; local $/; return scalar <$file> }

sub spill { open my $file, '>:raw', $_[0] or die "$_[0]: $!\n"; print $file $_[1]; close $file }

sub npy {
    my ($type, $pack, $width, @numbers) = @_;
    my $shape = sprintf "(%d, %d)", @numbers / $width, $width;
    my $head = "{'descr': '$type', 'fortran_order': False, 'shape': $shape, }";
    $head .= " " x (63 - (10 + length $head) % 64) . "\n";
    return "\x93NUMPY\x01\x00" . pack("v", length $head) . $head . pack($pack, @numbers);
}

sub permutations {
    my @rest = @_;
    return [] unless @rest;
    return map { my $i = $_; map [$rest[$i], @$_], permutations(@rest[grep $_ != $i, 0 .. $#rest]) }
        0 .. $#rest;
}

# Take the samples of a request.
sub take {
    my ($bytes, $ask) = @_;
    my $format = {'<f8' => 'd<*', '<i8' => 'q<*', '|u1' => 'C*'}->{$ask->{dtype}}
        or die "was sent $ask->{dtype}\n";
    my @values = unpack $format, $bytes;
    my @isovalue = @{$ask->{isovalues}};
    @shape = @{$ask->{shape}};
    $n = @shape;
    $m = $ask->{components};
    die "was sent $m fields in $n dimensions\n" if $n - $m != 1 || $m != @isovalue;
    my $size = 1;
    $size *= $_ for @shape;
    die "the file is too short\n" if @values != $m * $size;
    @f = map { my $c = $_; [map $_ - $isovalue[$c], @values[$c * $size .. ($c + 1) * $size - 1]] }
        0 .. $m - 1;
    $step[$n - 1] = 1;
    $step[$_] = $step[$_ + 1] * $shape[$_ + 1] for reverse 0 .. $n - 2;
    @paths = permutations(0 .. $n - 1);
}

sub det { my ($p, $q) = @_; return $f[0][$p] * $f[1][$q] - $f[0][$q] * $f[1][$p] }

# Weights of the zero among the corners of a face, or nothing where it has none.
sub zero {
    my @v = @_;
    if ($m == 1) {
        my ($a, $b) = map $f[0][$_], @v;
        return ($a >= 0) == ($b >= 0) ? () : ($b / ($b - $a), $a / ($a - $b));
    }
    my @w = (det(@v[1, 2]), -det(@v[0, 2]), det(@v[0, 1]));
    my @positive = (det(@v[1, 2]) >= 0, det(@v[0, 2]) < 0, det(@v[0, 1]) >= 0);
    my $sum = $w[0] + $w[1] + $w[2];
    my $count = grep $_, @positive;
    return () if $count % 3;
    return $sum ? map $_ / $sum, @w : (1 / 3) x 3;
}

sub place { my $v = shift; return map int($v / $step[$_]) % $shape[$_], 0 .. $n - 1 }

# The simplex of a path of samples: the piece of curve in it, if any, is a pair of its faces.
sub simplex {
    my ($path, @v) = @_;
    my @ends;
    for my $left (0 .. $n) {
        my @face = @v[grep $_ != $left, 0 .. $n];
        my @w = zero(@face) or next;
        my ($key, @point) = ("@face", (0) x $n);
        for my $c (0 .. $#face) {
            my @p = place($face[$c]);
            $point[$_] += $w[$c] * $p[$_] for 0 .. $n - 1;
        }
        $at{$key} = \@point;
        push @ends, $key;
    }
    return unless @ends == 2;
    push @links, ahead($path, \@v, @ends) ? [@ends] : [reverse @ends];
}

# Whether det(-g_1, .., -g_m, t) > 0 from the first end to the second. In the plane it is taken of
# signs, which have no ties: of f = 1 inside and -1 outside, whose zeros are halfway.
sub ahead {
    my ($path, $v, @ends) = @_;
    my @g;
    for my $c (0 .. $m - 1) {
        my @values = map $m == 1 ? ($f[0][$_] >= 0 ? 1 : -1) : $f[$c][$_], @$v;
        $g[$c][$path->[$_]] = $values[$_ + 1] - $values[$_] for 0 .. $n - 1;
    }
    my @t = map $at{$ends[1]}[$_] - $at{$ends[0]}[$_], 0 .. $n - 1;
    if ($m == 1) {
        my @middle = map { my @two = map [place($_)], split; [map $two[0][$_] + $two[1][$_], 0, 1] } @ends;
        @t = map $middle[1][$_] - $middle[0][$_], 0, 1;
        return $g[0][1] * $t[0] - $g[0][0] * $t[1] > 0;
    }
    my ($a, $b) = @g;
    my @cross = map { my ($i, $j) = (($_ + 1) % 3, ($_ + 2) % 3); $a->[$i] * $b->[$j] - $a->[$j] * $b->[$i] } 0 .. 2;
    return $t[0] * $cross[0] + $t[1] * $cross[1] + $t[2] * $cross[2] > 0;
}

# All links, cell by cell; a cell where a component keeps its sign has none.
sub cells {
    %at = ();
    @links = ();
    my @corners = (0);
    for my $axis (0 .. $n - 1) { push @corners, map $_ + $step[$axis], @corners }
    CELL: for my $low (0 .. $#{$f[0]}) {
        my @p = place($low);
        for (0 .. $n - 1) { next CELL if $p[$_] == $shape[$_] - 1 }
        for my $c (@f) {
            my $high = grep $c->[$low + $_] >= 0, @corners;
            next CELL if $high == 0 || $high == @corners;
        }
        for my $path (@paths) {
            my @v = ($low);
            push @v, $v[-1] + $step[$_] for @$path;
            simplex($path, @v);
        }
    }
}

# Lists of keys, open chains first; each in the direction of its links.
sub chains {
    my (%next, %done, @chains);
    for my $i (0 .. $#links) { push @{$next{$_}}, $i for @{$links[$i]} }
    for my $start ((grep @{$next{$_}} == 1, sort keys %next), sort keys %next) {
        my ($i) = grep !$done{$_}, @{$next{$start}};
        next unless defined $i;
        my ($turned, @chain) = ($links[$i][0] ne $start, $start);
        while (defined $i) {
            $done{$i} = 1;
            push @chain, $links[$i][$links[$i][0] eq $chain[-1] ? 1 : 0];
            ($i) = grep !$done{$_}, @{$next{$chain[-1]}};
        }
        push @chains, [$turned ? reverse @chain : @chain];
    }
    return @chains;
}

# A point of the mesh.
sub point {
    my ($key, $spacing, $origin) = @_;
    return map $at{$key}[$_] * $spacing->[$_] + $origin->[$_], 0 .. $n - 1;
}

# The answer: lists of points, or the names of .npy files that begin with the stem.
sub answer {
    my ($stem, $spacing, $origin) = @_;
    cells();
    return {polylines => [map { [map [point($_, $spacing, $origin)], @$_] } chains()]}
        if $form eq "polylines";
    my @keys = sort keys %at;
    my %number;
    @number{@keys} = 0 .. $#keys;
    spill("$stem.vertices.npy", npy('<f8', 'd<*', $n, map point($_, $spacing, $origin), @keys));
    spill("$stem.simplices.npy", npy('<i8', 'q<*', 2, map { @number{@$_} } @links));
    my ($name) = $stem =~ m{([^/]*)$};
    return {vertices => "$name.vertices.npy", simplices => "$name.simplices.npy"};
}

if (defined $folder) {
    my $manifest = decode_json(slurp("$folder/manifest.json"));
    spill("$folder/declaration.json", encode_json($declaration));
    for my $entry (@{$manifest->{fields}}) {
        my $bytes = slurp("$folder/$entry->{values}");
        $entry->{components} = $entry->{kind}[1];
        next unless eval { take(substr($bytes, 10 + unpack("v", substr $bytes, 8, 2)), $entry); 1 };
        my ($stem) = "$folder/$entry->{values}" =~ /(.*)\.npy$/;
        my $said = answer($stem, $entry->{spacing}, $entry->{origin});
        spill("$stem.json", encode_json($said)) if $form eq "polylines";
    }
    exit;
}
$| = 1;
while (my $line = <STDIN>) {
    my $ask = decode_json($line);
    last if $ask->{command} eq "stop";
    my $said = {protocol => 3, declaration => $declaration};
    if ($ask->{command} eq "run") {
        my $taken = eval { take(substr(slurp($ask->{values}), $ask->{offset}), $ask); 1 };
        $said = $taken ? answer("$ask->{directory}/a", $ask->{spacing}, [(0) x $n]) : {error => $@};
        $said->{id} = $ask->{id};
    }
    print encode_json($said), "\n";
}

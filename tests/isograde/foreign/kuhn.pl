#!/usr/bin/perl
# Contours, curves, and simplices of dimension 1, by Kuhn's simplices: each cell is cut along its
# main diagonal, and the fields are linear on each piece.
#
#   perl kuhn.pl curves            speaks the protocol of exec: on standard input
#   perl kuhn.pl curves FOLDER     answers every field of an exported folder, for dir:
use strict;
use warnings;
use JSON::PP;

my ($kind, $folder) = @ARGV;
# A common zero on the edge of a simplex may be missed by one neighbour, so simplices may leak.
my $declaration = {name => "Kuhn in Perl", discipline => $kind, level => $kind eq "simplices" ? 0 : 2,
                   without => $kind eq "contours" ? ["on-edges"] : []};
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

# The samples of a request; why it cannot be met, or nothing.
sub take {
    my ($bytes, $ask) = @_;
    my $format = {'<f8' => 'd<*', '<i8' => 'q<*', '|u1' => 'C*'}->{$ask->{dtype}}
        or return "reads float64, int64 and uint8 only";
    my @values = unpack $format, $bytes;
    @shape = @{$ask->{shape}};
    $n = @{$ask->{spacing}};
    my $parts = @shape > $n ? shift @shape : 1;
    $m = $kind eq "curves" ? 2 : $parts;
    return "has simplices of dimension 1 only" if $n - $m != 1;
    my $size = 1;
    $size *= $_ for @shape;
    die "the file is too short\n" if @values != $parts * $size;
    my @isovalue = ($ask->{isovalue}) x $m;
    $isovalue[1] = $values[2 * $size] if $kind eq "curves" && $parts == 3;
    @f = map { my $c = $_; [map $_ - $isovalue[$c], @values[$c * $size .. ($c + 1) * $size - 1]] }
        0 .. $m - 1;
    $step[$n - 1] = 1;
    $step[$_] = $step[$_ + 1] * $shape[$_ + 1] for reverse 0 .. $n - 2;
    @paths = permutations(0 .. $n - 1);
    return;
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

# The arrays of an answer, as .npy files beside each other.
sub answer {
    my ($stem, $spacing, $origin) = @_;
    cells();
    my (@keys, @second);
    if ($kind eq "simplices") {
        my %number;
        @keys = sort keys %at;
        @number{@keys} = 0 .. $#keys;
        @second = map { ($number{$_->[0]}, $number{$_->[1]}) } @links;
    } else {
        my @chains = chains();
        for my $c (0 .. $#chains) { push @keys, @{$chains[$c]}; push @second, ($c) x @{$chains[$c]} }
    }
    my @points = map { my $p = $at{$_}; map $p->[$_] * $spacing->[$_] + $origin->[$_], 0 .. $n - 1 } @keys;
    spill("$stem.vertices.npy", npy('<f8', 'd<*', $n, @points));
    spill("$stem.faces.npy", npy('<i8', 'q<*', $kind eq "simplices" ? 2 : 1, @second));
}

if (defined $folder) {
    my $manifest = decode_json(slurp("$folder/manifest.json"));
    spill("$folder/declaration.json", encode_json($declaration));
    for my $entry (@{$manifest->{fields}}) {
        my $bytes = slurp("$folder/$entry->{values}");
        my $refused = take(substr($bytes, 10 + unpack("v", substr $bytes, 8, 2)), $entry);
        my ($stem) = "$folder/$entry->{values}" =~ /(.*)\.npy$/;
        answer($stem, $entry->{spacing}, $entry->{origin}) unless defined $refused;
    }
    exit;
}
$| = 1;
while (my $line = <STDIN>) {
    my $ask = decode_json($line);
    last if $ask->{command} eq "stop";
    my $said = {protocol => 2, declaration => $declaration};
    if ($ask->{command} eq "run") {
        my $refused = eval { take(substr(slurp($ask->{values}), $ask->{offset}), $ask) };
        $said = $@ ? {error => $@} : defined $refused ? {unsupported => $refused}
            : {vertices => "a.vertices.npy", faces => "a.faces.npy"};
        answer("$ask->{directory}/a", $ask->{spacing}, [(0) x $n]) if $said->{vertices};
        $said->{id} = $ask->{id};
    }
    print encode_json($said), "\n";
}

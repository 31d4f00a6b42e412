(** * The local conditions: of one tile, and of two tiles at a face *)

From Coq Require Import ZArith NArith List Bool Relations.
From Proofs Require Import Lattice.
Import ListNotations.
Open Scope Z_scope.

(** What tiles draw on a face is fixed by an interface: for each kind of face the segments that the
    cell below has there, and chords (edges with two triangles) that it, and the cell above, may
    have. Edges on a face are written as the cell above sees them, with coordinate 0. *)
Record interface := Interface {
  segments : axis -> face -> list edge;
  chords_below : axis -> face -> list edge;
  chords_above : axis -> face -> list edge }.

(** Cells that can occur: decisions on ambiguous faces only, and the cell's own in range. *)
Definition amb (f : face) : bool := ambiguous (f00 f) (f10 f) (f01 f) (f11 f).
Definition possible (choices : N) (k : conf) : Prop :=
  (forall a, decided (low_face a k) = true -> amb (low_face a k) = true) /\
  (forall a, decided (high_face a k) = true -> amb (high_face a k) = true) /\
  (inner k < choices)%N.

Record conditions (choices : N) (T : tiles) (I : interface) : Prop := {

  (** Condition 1: triangles have three different nodes of the cell; no directed edge twice. *)
  nodes_local : forall k, possible choices k -> forall a b c, In (a, b, c) (T k) ->
    (local a /\ local b /\ local c) /\ (a <> b /\ b <> c /\ c <> a);
  once : forall k, possible choices k -> NoDup (directed (T k));

  (** Condition 1 also: nodes on lattice edges are those of crossed edges. *)
  nodes_crossed : forall k, possible choices k -> forall n, on_edge n ->
    (exists w, around (T k) n w) <-> crossed k n = true;

  (** Condition 2: an edge with one triangle lies on a face, with the inside on the right. *)
  segments_on_faces : forall k, possible choices k -> forall e,
    In e (directed (T k)) -> ~ In (swap e) (directed (T k)) ->
    exists a side, even2 side /\ ncoord a (fst e) = side /\ ncoord a (snd e) = side /\
                   inside_on_the_right k a side e;

  (** Condition 3: on a face it is a segment of the interface, and each of these is there. *)
  flat : forall a f e, In e (segments I a f) -> ncoord a (fst e) = 0 /\ ncoord a (snd e) = 0;
  below_segments : forall k, possible choices k -> forall a x y,
    ncoord a x = 2 -> ncoord a y = 2 ->
    In (x, y) (directed (T k)) -> ~ In (y, x) (directed (T k)) ->
    In (nset a 0 x, nset a 0 y) (segments I a (high_face a k));
  below_has : forall k, possible choices k -> forall a x y,
    In (x, y) (segments I a (high_face a k)) ->
    In (nset a 2 x, nset a 2 y) (directed (T k)) /\
    ~ In (nset a 2 y, nset a 2 x) (directed (T k));
  above_segments : forall k, possible choices k -> forall a x y,
    ncoord a x = 0 -> ncoord a y = 0 ->
    In (x, y) (directed (T k)) -> ~ In (y, x) (directed (T k)) ->
    In (y, x) (segments I a (low_face a k));
  above_has : forall k, possible choices k -> forall a x y,
    In (x, y) (segments I a (low_face a k)) ->
    In (y, x) (directed (T k)) /\ ~ In (x, y) (directed (T k));

  (** Condition 4: no chord of a face is one of the cell below and of the cell above. *)
  below_chords : forall k, possible choices k -> forall a x y,
    ncoord a x = 2 -> ncoord a y = 2 ->
    In (x, y) (directed (T k)) -> In (y, x) (directed (T k)) ->
    In (nset a 0 x, nset a 0 y) (chords_below I a (high_face a k));
  above_chords : forall k, possible choices k -> forall a x y,
    ncoord a x = 0 -> ncoord a y = 0 ->
    In (x, y) (directed (T k)) -> In (y, x) (directed (T k)) ->
    In (x, y) (chords_above I a (low_face a k));
  chords_apart : forall a f e, In e (chords_below I a f) -> ~ In e (chords_above I a f);

  (** Condition 5: the triangles at a node hang together; at the node of a lattice edge they reach
      both faces of the cell there. *)
  one_fan : forall k, possible choices k -> forall v w w',
    around (T k) v w -> around (T k) v w' -> linked (T k) v w w';
  fan_ends : forall k, possible choices k -> forall v w, on_edge v -> around (T k) v w ->
    forall a, even2 (ncoord a v) -> exists u, ncoord a u = ncoord a v /\
      ((In (v, u) (directed (T k)) /\ ~ In (u, v) (directed (T k))) \/
       (In (u, v) (directed (T k)) /\ ~ In (v, u) (directed (T k))))
}.

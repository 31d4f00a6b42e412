(** * The lattice, its samples, a rule's tiles, and the mesh they make

    Nothing is proved in this file: it holds what a reader must agree with. *)

From Coq Require Import ZArith NArith List Bool Relations.
Import ListNotations.
Open Scope Z_scope.

(** ** Points, nodes, edges, triangles *)

Record point := P { px : Z; py : Z; pz : Z }.

Inductive axis := Ax | Ay | Az.

Definition coord (a : axis) (p : point) : Z :=
  match a with Ax => px p | Ay => py p | Az => pz p end.

Definition set (a : axis) (z : Z) (p : point) : point :=
  match a with
  | Ax => P z (py p) (pz p)
  | Ay => P (px p) z (pz p)
  | Az => P (px p) (py p) z
  end.

(** A sample stands at a point with whole coordinates, and a cell is named by its lowest corner. The
    places of nodes are doubled, so that the middle of a lattice edge has whole coordinates too: in
    a cell they run from 0 to 2. [nr] tells interior points of one cell apart. *)
Record node := Node { at_ : point; nr : Z }.

Definition edge := (node * node)%type.
Definition triangle := (node * node * node)%type.

Definition ncoord (a : axis) (n : node) : Z := coord a (at_ n).
Definition nset (a : axis) (z : Z) (n : node) : node := Node (set a z (at_ n)) (nr n).

Definition swap (e : edge) : edge := (snd e, fst e).

(** The directed edges of some triangles. *)
Definition sides (t : triangle) : list edge :=
  let '(a, b, c) := t in [(a, b); (b, c); (c, a)].
Definition directed (ts : list triangle) : list edge := flat_map sides ts.

(** A triangle at [v] leads from one of its other nodes to the next. *)
Definition corner (ts : list triangle) (v w x : node) : Prop :=
  In (v, w, x) ts \/ In (x, v, w) ts \/ In (w, x, v) ts.

(** The neighbours of a node, and walking from one to another round it. *)
Definition around (ts : list triangle) (v w : node) : Prop :=
  exists x, corner ts v w x \/ corner ts v x w.
Definition linked (ts : list triangle) (v : node) : node -> node -> Prop :=
  clos_refl_sym_trans node (corner ts v).

(** The steps of a circle: from each to the next, and from the last to the first. *)
Definition turns {A} (l : list A) : list (A * A) :=
  match l with [] => [] | a :: m => combine l (m ++ [a]) end.

(** One follows another in a list. *)
Definition consecutive {A} (l : list A) (a b : A) : Prop :=
  exists l1 l2, l = l1 ++ a :: b :: l2.

(** The node of a lattice edge of the cell 0: its middle. *)
Definition even2 (z : Z) : Prop := z = 0 \/ z = 2.
Definition on_edge (n : node) : Prop :=
  nr n = 0 /\
  ((ncoord Ax n = 1 /\ even2 (ncoord Ay n) /\ even2 (ncoord Az n)) \/
   (ncoord Ay n = 1 /\ even2 (ncoord Ax n) /\ even2 (ncoord Az n)) \/
   (ncoord Az n = 1 /\ even2 (ncoord Ax n) /\ even2 (ncoord Ay n))).
Definition interior (n : node) : Prop :=
  ncoord Ax n = 1 /\ ncoord Ay n = 1 /\ ncoord Az n = 1.
Definition local (n : node) : Prop := on_edge n \/ interior n.

(** ** Fields, and what a cell sees of them *)

(** Which samples are inside. Nothing else of the values enters the mesh, but for decisions. *)
Definition samples := point -> bool.

(** A face is named by its axis and its lowest corner. A decision on a face is one bit of the face:
    here is the premise that both cells at a face come to the same decision. *)
Definition face_decisions := axis -> point -> bool.

(** Further decisions, of each cell by itself. *)
Definition cell_decisions := point -> N.

(** What is known of a face: its four samples, in the order of its two axes, and its decision. *)
Record face := Face { f00 : bool; f10 : bool; f01 : bool; f11 : bool; decided : bool }.

Definition ambiguous (b00 b10 b01 b11 : bool) : bool :=
  eqb b00 b11 && eqb b10 b01 && negb (eqb b00 b10).

(** What is known of a cell: its eight samples, the decisions on its low and high faces, its own. *)
Record conf := Conf {
  c000 : bool; c100 : bool; c010 : bool; c110 : bool;
  c001 : bool; c101 : bool; c011 : bool; c111 : bool;
  lowx : bool; highx : bool; lowy : bool; highy : bool; lowz : bool; highz : bool;
  inner : N }.

Definition low_face (a : axis) (k : conf) : face :=
  match a with
  | Ax => Face (c000 k) (c010 k) (c001 k) (c011 k) (lowx k)
  | Ay => Face (c000 k) (c100 k) (c001 k) (c101 k) (lowy k)
  | Az => Face (c000 k) (c100 k) (c010 k) (c110 k) (lowz k)
  end.
Definition high_face (a : axis) (k : conf) : face :=
  match a with
  | Ax => Face (c100 k) (c110 k) (c101 k) (c111 k) (highx k)
  | Ay => Face (c010 k) (c110 k) (c011 k) (c111 k) (highy k)
  | Az => Face (c001 k) (c101 k) (c011 k) (c111 k) (highz k)
  end.

(** Only ambiguous faces are decided. *)
Definition decision (s : samples) (d : face_decisions) (a : axis) (p : point) : bool :=
  let '(P x y z) := p in
  match a with
  | Ax => ambiguous (s (P x y z)) (s (P x (y+1) z)) (s (P x y (z+1))) (s (P x (y+1) (z+1)))
  | Ay => ambiguous (s (P x y z)) (s (P (x+1) y z)) (s (P x y (z+1))) (s (P (x+1) y (z+1)))
  | Az => ambiguous (s (P x y z)) (s (P (x+1) y z)) (s (P x (y+1) z)) (s (P (x+1) (y+1) z))
  end && d a p.

Definition conf_of (s : samples) (d : face_decisions) (i : cell_decisions) (c : point) : conf :=
  let '(P x y z) := c in
  Conf (s (P x y z)) (s (P (x+1) y z)) (s (P x (y+1) z)) (s (P (x+1) (y+1) z))
       (s (P x y (z+1))) (s (P (x+1) y (z+1))) (s (P x (y+1) (z+1))) (s (P (x+1) (y+1) (z+1)))
       (decision s d Ax (P x y z)) (decision s d Ax (P (x+1) y z))
       (decision s d Ay (P x y z)) (decision s d Ay (P x (y+1) z))
       (decision s d Az (P x y z)) (decision s d Az (P x y (z+1)))
       (i c).

(** ** Rules and meshes *)

(** A rule's tile: triangles on the nodes of the cell 0. *)
Definition tiles := conf -> list triangle.

Definition move (c : point) (n : node) : node :=
  Node (P (px (at_ n) + 2 * px c) (py (at_ n) + 2 * py c) (pz (at_ n) + 2 * pz c)) (nr n).
Definition move_triangle (c : point) (t : triangle) : triangle :=
  let '(a, b, d) := t in (move c a, move c b, move c d).

(** A lattice of [nx] x [ny] x [nz] cells. *)
Definition range (n : nat) : list Z := map Z.of_nat (seq 0 n).
Definition box (nx ny nz : nat) : list point :=
  flat_map (fun x => flat_map (fun y => map (P x y) (range nz)) (range ny)) (range nx).

Definition mesh (T : tiles) s d i (cells : list point) : list triangle :=
  flat_map (fun c => map (move_triangle c) (T (conf_of s d i c))) cells.

(** The border of the lattice: its six outer planes. *)
Definition size (nx ny nz : nat) (a : axis) : Z :=
  match a with Ax => Z.of_nat nx | Ay => Z.of_nat ny | Az => Z.of_nat nz end.
Definition in_border (nx ny nz : nat) (n : node) : Prop :=
  exists a, ncoord a n = 0 \/ ncoord a n = 2 * size nx ny nz a.
Definition edge_in_border (nx ny nz : nat) (e : edge) : Prop :=
  exists a, (ncoord a (fst e) = 0 /\ ncoord a (snd e) = 0) \/
            (ncoord a (fst e) = 2 * size nx ny nz a /\ ncoord a (snd e) = 2 * size nx ny nz a).

(** ** Sides *)

(** The sample at a corner of the cell, whose coordinates are 0 and 2. *)
Definition sample (k : conf) (p : point) : bool :=
  match Z.eqb (px p) 0, Z.eqb (py p) 0, Z.eqb (pz p) 0 with
  | true, true, true => c000 k | false, true, true => c100 k
  | true, false, true => c010 k | false, false, true => c110 k
  | true, true, false => c001 k | false, true, false => c101 k
  | true, false, false => c011 k | false, false, false => c111 k
  end.

(** The ends of the lattice edge with the middle [p]: where a coordinate is 1 put 0, or 2. *)
Definition low_end (p : point) : point :=
  let f z := if Z.eqb z 1 then 0 else z in P (f (px p)) (f (py p)) (f (pz p)).
Definition high_end (p : point) : point :=
  let f z := if Z.eqb z 1 then 2 else z in P (f (px p)) (f (py p)) (f (pz p)).

Definition crossed (k : conf) (n : node) : bool :=
  negb (eqb (sample k (low_end (at_ n))) (sample k (high_end (at_ n)))).

(** The surface runs from [fst e] to [snd e] on the face of axis [a] at [side], 0 or 2. The inside is
    on the right, for someone who looks at the cell from outside, where the frame (ahead, towards
    the inside, outwards) is left-handed. *)
Definition minus (p q : point) : point := P (px p - px q) (py p - py q) (pz p - pz q).
Definition det (p q r : point) : Z :=
  px p * (py q * pz r - pz q * py r) - py p * (px q * pz r - pz q * px r)
  + pz p * (px q * py r - py q * px r).
Definition inside_on_the_right (k : conf) (a : axis) (side : Z) (e : edge) : Prop :=
  let p := at_ (fst e) in
  let inner_end := if sample k (low_end p) then low_end p else high_end p in
  det (minus (at_ (snd e)) p) (minus inner_end p) (set a (side - 1) (P 0 0 0)) < 0.

(** ** What is proved of a rule

    For all samples, all decisions on faces, all decisions in cells that are less than [choices], and
    every finite lattice, the mesh [M] is a surface by index. *)

Record surface (s : samples) (d : face_decisions) (i : cell_decisions) (T : tiles) (nx ny nz : nat)
               (M : list triangle) : Prop := {

  (** Oriented: no directed edge occurs twice. So an edge has two triangles at most, and two run
      along it in opposite directions. *)
  oriented : NoDup (directed M);
  proper : forall a b, In (a, b) (directed M) -> a <> b;

  (** Closed: off the border of the lattice each edge has two. *)
  closed : forall e, In e (directed M) -> ~ edge_in_border nx ny nz e -> In (swap e) (directed M);

  (** Manifold: off the border the neighbours of a vertex are a circle of different nodes, and its
      triangles lead from each to the next. *)
  full_turn : forall v w, around M v w -> ~ in_border nx ny nz v ->
    exists circle, NoDup circle /\ forall a b, corner M v a b <-> In (a, b) (turns circle);

  (** In the border they are a path. *)
  open_fan : forall v w, around M v w -> in_border nx ny nz v ->
    exists path, NoDup path /\ forall a b, corner M v a b <-> consecutive path a b;

  (** Its vertices on lattice edges are one for each crossed edge. *)
  on_crossed_edges : forall c n, In c (box nx ny nz) -> on_edge n ->
    ((exists w, around M (move c n) w) <-> crossed (conf_of s d i c) n = true);

  (** On a face of a cell the tile's border has the inside on its right. *)
  inside_behind : forall c e, In c (box nx ny nz) ->
    In e (directed (T (conf_of s d i c))) -> ~ In (swap e) (directed (T (conf_of s d i c))) ->
    exists a side, even2 side /\ ncoord a (fst e) = side /\ ncoord a (snd e) = side /\
                   inside_on_the_right (conf_of s d i c) a side e
}.

Definition makes_surfaces (choices : N) (T : tiles) : Prop :=
  forall s d i, (forall c, (i c < choices)%N) -> forall nx ny nz,
  surface s d i T nx ny nz (mesh T s d i (box nx ny nz)).

(** * Lists, the box of cells, and nodes that two cells share *)

From Coq Require Import ZArith NArith List Bool Relations Lia.
From Proofs Require Import Lattice Conditions.
Import ListNotations.
Open Scope Z_scope.

(** ** Lists *)

Lemma in_directed ts x y :
  In (x, y) (directed ts) <->
  exists a b c, In (a, b, c) ts /\
    ((x = a /\ y = b) \/ (x = b /\ y = c) \/ (x = c /\ y = a)).
Proof.
  unfold directed. rewrite in_flat_map. split.
  - intros [[[a b] c] [H S]]. exists a, b, c. split; [exact H|].
    simpl in S. destruct S as [S|[S|[S|[]]]]; inversion S; subst; auto.
  - intros (a & b & c & H & S). exists (a, b, c). split; [exact H|]. simpl.
    destruct S as [[-> ->]|[[-> ->]|[-> ->]]]; auto.
Qed.

Lemma corner_directed ts v w x : corner ts v w x ->
  In (v, w) (directed ts) /\ In (w, x) (directed ts) /\ In (x, v) (directed ts).
Proof.
  intros [H|[H|H]]; repeat split; apply in_directed.
  - exists v, w, x. auto.
  - exists v, w, x. auto.
  - exists v, w, x. auto.
  - exists x, v, w. auto.
  - exists x, v, w. auto.
  - exists x, v, w. auto.
  - exists w, x, v. auto.
  - exists w, x, v. auto.
  - exists w, x, v. auto.
Qed.

Lemma directed_corner ts v w : In (v, w) (directed ts) -> exists x, corner ts v w x.
Proof.
  intros (a & b & c & H & S)%in_directed. unfold corner.
  destruct S as [[-> ->]|[[-> ->]|[-> ->]]]; eauto.
Qed.

Lemma directed_corner_back ts v w : In (w, v) (directed ts) -> exists x, corner ts v x w.
Proof.
  intros (a & b & c & H & S)%in_directed. unfold corner.
  destruct S as [[-> ->]|[[-> ->]|[-> ->]]]; eauto.
Qed.

Lemma around_directed ts v w :
  around ts v w <-> In (v, w) (directed ts) \/ In (w, v) (directed ts).
Proof.
  split.
  - intros [x [H|H]]; apply corner_directed in H; tauto.
  - intros [H|H]; [apply directed_corner in H|apply directed_corner_back in H];
      destruct H as [x H]; exists x; auto.
Qed.

Lemma NoDup_app A (l m : list A) :
  NoDup l -> NoDup m -> (forall x, In x l -> ~ In x m) -> NoDup (l ++ m).
Proof.
  induction 1 as [|a l Ha Hl IH]; simpl; intros Hm H; [exact Hm|].
  constructor.
  - rewrite in_app_iff. intros [X|X]; [auto|]. apply (H a); simpl; auto.
  - apply IH; [exact Hm|]. intros x X. apply H. simpl. auto.
Qed.

Lemma NoDup_flat_map A B (f : A -> list B) l :
  NoDup l -> (forall x, In x l -> NoDup (f x)) ->
  (forall x y z, In x l -> In y l -> In z (f x) -> In z (f y) -> x = y) ->
  NoDup (flat_map f l).
Proof.
  induction 1 as [|a l Ha Hl IH]; simpl; intros H1 H2; [constructor|].
  apply NoDup_app.
  - apply H1. auto.
  - apply IH; [auto|]. intros x y z Hx Hy. apply H2; auto.
  - intros z Hz Hz'. apply in_flat_map in Hz'. destruct Hz' as [y [Hy Hz']].
    apply Ha. rewrite (H2 a y z); auto.
Qed.

Lemma NoDup_map_injective A B (f : A -> B) l :
  (forall x y, f x = f y -> x = y) -> NoDup l -> NoDup (map f l).
Proof.
  intros F. induction 1 as [|a l Ha Hl IH]; simpl; constructor; [|exact IH].
  rewrite in_map_iff. intros [x [E X]]. apply F in E. subst. contradiction.
Qed.

(** What is once in a list of lists is in one of them. *)
Lemma in_flat_map_once A B (f : A -> list B) l : NoDup (flat_map f l) ->
  forall x y e, In x l -> In y l -> In e (f x) -> In e (f y) -> x = y.
Proof.
  induction l as [|a l IH]; simpl; intros N x y e; [intros []|].
  assert (Nl : NoDup (flat_map f l)).
  { clear IH. induction (f a) as [|b m IHm]; [exact N|]. inversion N. auto. }
  assert (D : forall e, In e (f a) -> ~ In e (flat_map f l)).
  { clear IH. induction (f a) as [|b m IHm]; [intros ? []|].
    inversion N as [|? ? Nb Nm]; subst. intros z [->|Z] Z'.
    - apply Nb. apply in_or_app. auto.
    - apply (IHm Nm z Z Z'). }
  intros [<-|X] [<-|Y] Ex Ey.
  - reflexivity.
  - exfalso. apply (D e Ex). apply in_flat_map. eauto.
  - exfalso. apply (D e Ey). apply in_flat_map. eauto.
  - eapply IH; eauto.
Qed.

(** ** The box of cells *)

Lemma in_range n z : In z (range n) <-> 0 <= z < Z.of_nat n.
Proof.
  unfold range. rewrite in_map_iff. split.
  - intros [k [E K]]. apply in_seq in K. lia.
  - intros H. exists (Z.to_nat z). split; [lia|]. apply in_seq. lia.
Qed.

Lemma NoDup_range n : NoDup (range n).
Proof. apply NoDup_map_injective; [lia|apply seq_NoDup]. Qed.

Lemma in_box nx ny nz c :
  In c (box nx ny nz) <-> forall a, 0 <= coord a c < size nx ny nz a.
Proof.
  unfold box. rewrite in_flat_map. split.
  - intros (x & X & H). apply in_flat_map in H. destruct H as (y & Y & H).
    apply in_map_iff in H. destruct H as (z & E & Z). subst c.
    apply in_range in X. apply in_range in Y. apply in_range in Z.
    intros a. destruct a; assumption.
  - intros H. destruct c as [x y z].
    exists x. split; [apply in_range, (H Ax)|]. apply in_flat_map.
    exists y. split; [apply in_range, (H Ay)|]. apply in_map_iff.
    exists z. split; [reflexivity|apply in_range, (H Az)].
Qed.

Lemma NoDup_box nx ny nz : NoDup (box nx ny nz).
Proof.
  unfold box. apply NoDup_flat_map.
  - apply NoDup_range.
  - intros x _. apply NoDup_flat_map.
    + apply NoDup_range.
    + intros y _. apply NoDup_map_injective; [congruence|apply NoDup_range].
    + intros y y' p _ _ H H'. apply in_map_iff in H. apply in_map_iff in H'.
      destruct H as [z [<- _]], H' as [z' [E _]]. congruence.
  - intros x x' p _ _ H H'. apply in_flat_map in H. apply in_flat_map in H'.
    destruct H as [y [_ H]], H' as [y' [_ H']].
    apply in_map_iff in H. apply in_map_iff in H'.
    destruct H as [z [<- _]], H' as [z' [E _]]. congruence.
Qed.

(** ** Nodes of two cells *)

Definition up (a : axis) (c : point) : point := set a (coord a c + 1) c.

Ltac unpack :=
  unfold local, on_edge, interior, even2, ncoord, nset, up, move, set, coord in *;
  cbn [at_ nr px py pz] in *.

Lemma node_eq m n : at_ m = at_ n -> nr m = nr n -> m = n.
Proof. destruct m, n; simpl; congruence. Qed.

Lemma move_injective c m n : move c m = move c n -> m = n.
Proof.
  destruct m as [[x y z] k], n as [[x' y' z'] k']. unfold move; cbn [at_ nr px py pz]. intros E.
  injection E; intros. apply node_eq; simpl; [f_equal|]; lia.
Qed.

Lemma move_up a c n : ncoord a n = 2 -> move (up a c) (nset a 0 n) = move c n.
Proof.
  destruct a, c as [x y z], n as [[nx ny nz] k]; unpack; intros ->; do 2 f_equal; lia.
Qed.

Lemma move_up' a c n : ncoord a n = 0 -> move c (nset a 2 n) = move (up a c) n.
Proof.
  destruct a, c as [x y z], n as [[nx ny nz] k]; unpack; intros ->; do 2 f_equal; lia.
Qed.

Lemma nset_nset a z z' n : nset a z (nset a z' n) = nset a z n.
Proof. destruct a, n as [[x y w] k]; reflexivity. Qed.

Lemma nset_same a z n : ncoord a n = z -> nset a z n = n.
Proof. destruct a, n as [[x y w] k]; unpack; intros ->; reflexivity. Qed.

Lemma ncoord_nset a z n : ncoord a (nset a z n) = z.
Proof. destruct a, n as [[x y w] k]; reflexivity. Qed.

Lemma up_injective_in a c c' : up a c = up a c' -> c = c'.
Proof.
  destruct a, c as [x y z], c' as [x' y' z']; unfold up, set, coord; cbn [px py pz]; intros E; injection E; intros; f_equal; lia.
Qed.

(** Along one axis two cells are in one place, or next to each other; then both nodes are between. *)
Lemma one_axis x x' m n m' n' :
  0 <= m <= 2 -> 0 <= n <= 2 -> 0 <= m' <= 2 -> 0 <= n' <= 2 ->
  m + 2 * x = m' + 2 * x' -> n + 2 * x = n' + 2 * x' ->
  (x' = x /\ m' = m /\ n' = n) \/
  (x' = x + 1 /\ m = 2 /\ n = 2 /\ m' = 0 /\ n' = 0) \/
  (x = x' + 1 /\ m = 0 /\ n = 0 /\ m' = 2 /\ n' = 2).
Proof. lia. Qed.

Lemma local_range n : local n ->
  0 <= ncoord Ax n <= 2 /\ 0 <= ncoord Ay n <= 2 /\ 0 <= ncoord Az n <= 2.
Proof. unfold local, on_edge, interior, even2. intuition lia. Qed.

Lemma axis_eq (a b : axis) : {a = b} + {a <> b}.
Proof. decide equality. Qed.

(** Two coordinates that are even leave one node. *)
Lemma local_even n : local n ->
  (ncoord Ax n = 1 \/ ncoord Ay n = 1 \/ ncoord Az n = 1) /\
  (ncoord Ax n <> 1 \/ ncoord Ay n <> 1 \/ ncoord Az n <> 1 -> nr n = 0).
Proof. unfold local, on_edge, interior, even2. intuition lia. Qed.

(** Two nodes on two faces of a cell are one. *)
Lemma one_common_face m n a b : local m -> local n -> m <> n ->
  ncoord a m = ncoord a n -> ncoord b m = ncoord b n ->
  ncoord a m <> 1 -> ncoord b m <> 1 -> a = b.
Proof.
  intros Lm Ln D Ea Eb Na Nb.
  pose proof (local_even _ Lm) as (Om & Km). pose proof (local_even _ Ln) as (On & Kn).
  assert (G : nr m = 0 /\ nr n = 0).
  { split; [apply Km|apply Kn]; destruct a; lia. }
  destruct (axis_eq a b) as [E|E]; [exact E|exfalso].
  clear Lm Ln Km Kn. destruct m as [[mx my mz] mk], n as [[nx ny nz] nk].
  unfold ncoord, coord in *. cbn [at_ nr px py pz] in *. destruct G as [-> ->].
  destruct a, b; try (exfalso; apply E; reflexivity); apply D; apply node_eq; cbn [at_ nr];
    try reflexivity; f_equal; lia.
Qed.

(** Two cells that both have two different nodes are one cell, or share a face. *)
Lemma two_nodes c c' m n m' n' :
  local m -> local n -> local m' -> local n' -> m <> n ->
  move c m = move c' m' -> move c n = move c' n' ->
  c = c' \/
  (exists a, c' = up a c /\ ncoord a m = 2 /\ ncoord a n = 2 /\
             m' = nset a 0 m /\ n' = nset a 0 n) \/
  (exists a, c = up a c' /\ ncoord a m' = 2 /\ ncoord a n' = 2 /\
             m = nset a 0 m' /\ n = nset a 0 n').
Proof.
  intros Lm Ln Lm' Ln' D Em En.
  pose proof (local_range _ Lm) as (R1 & R2 & R3).
  pose proof (local_range _ Ln) as (S1 & S2 & S3).
  pose proof (local_range _ Lm') as (R1' & R2' & R3').
  pose proof (local_range _ Ln') as (S1' & S2' & S3').
  pose proof (local_even _ Lm) as (Om & Km).
  pose proof (local_even _ Ln) as (On & Kn).
  clear Lm Ln Lm' Ln'.
  destruct c as [x y z], c' as [x' y' z'].
  destruct m as [[mx my mz] mk], n as [[nx ny nz] nk].
  destruct m' as [[mx' my' mz'] mk'], n' as [[nx' ny' nz'] nk'].
  unfold move in Em, En. unfold ncoord, coord in *. cbn [at_ nr px py pz] in *.
  injection Em as Emx Emy Emz Emk. injection En as Enx Eny Enz Enk.
  pose proof (one_axis _ _ _ _ _ _ R1 S1 R1' S1' Emx Enx) as HX.
  pose proof (one_axis _ _ _ _ _ _ R2 S2 R2' S2' Emy Eny) as HY.
  pose proof (one_axis _ _ _ _ _ _ R3 S3 R3' S3' Emz Enz) as HZ.
  clear R1 R2 R3 S1 S2 S3 R1' R2' R3' S1' S2' S3' Emx Emy Emz Enx Eny Enz.
  (* Where two axes move, the third coordinate of both nodes is 1, and they are one. *)
  assert (E : mk = 0 -> nk = 0 -> mx = nx -> my = ny -> mz = nz -> False).
  { intros. subst. contradiction. }
  unfold up, nset, set, coord. cbn [at_ nr px py pz].
  destruct HX as [(-> & -> & ->)|[(-> & -> & -> & -> & ->)|(-> & -> & -> & -> & ->)]];
  destruct HY as [(-> & -> & ->)|[(-> & -> & -> & -> & ->)|(-> & -> & -> & -> & ->)]];
  destruct HZ as [(-> & -> & ->)|[(-> & -> & -> & -> & ->)|(-> & -> & -> & -> & ->)]];
  subst;
  try (exfalso; apply E; try reflexivity; lia);
  [ left; reflexivity
  | right; left; exists Az | right; right; exists Az
  | right; left; exists Ay | right; right; exists Ay
  | right; left; exists Ax | right; right; exists Ax ];
  cbn [at_ nr px py pz]; repeat split; reflexivity.
Qed.

(** ** Lattice edges *)

Definition doubled (p : point) : point := P (2 * px p) (2 * py p) (2 * pz p).
Definition edge_node (a : axis) (p : point) : node :=
  Node (set a (2 * coord a p + 1) (doubled p)) 0.

Lemma edge_node_injective a a' p p' : edge_node a p = edge_node a' p' -> a = a' /\ p = p'.
Proof.
  destruct a, a', p as [x y z], p' as [x' y' z'];
    unfold edge_node, set, coord, doubled; cbn [px py pz]; intros E;
    pose proof (f_equal (ncoord Ax) E) as X; pose proof (f_equal (ncoord Ay) E) as Y;
    pose proof (f_equal (ncoord Az) E) as Z; unfold ncoord, coord in X, Y, Z;
    cbn [at_ px py pz] in X, Y, Z; clear E;
    first [exfalso; lia | split; [reflexivity|f_equal; lia]].
Qed.

Lemma crossed_negb b b' : negb (eqb b b') = true <-> b <> b'.
Proof. destruct b, b'; cbn; split; congruence. Qed.

(** Whether a node's edge is crossed is a matter of the lattice's samples, not of a cell. *)
Lemma crossed_samples s d i c n : on_edge n -> exists a p,
  move c n = edge_node a p /\
  (crossed (conf_of s d i c) n = true <-> s p <> s (up a p)).
Proof.
  destruct c as [x y z], n as [[nx ny nz] k]. unfold on_edge, ncoord, coord, even2.
  cbn [at_ nr px py pz].
  intros [-> [(-> & [->| ->] & [->| ->])|[(-> & [->| ->] & [->| ->])|(-> & [->| ->] & [->| ->])]]];
  unfold crossed, edge_node, doubled, up, set, coord, move.
  1: exists Ax, (P x y z).
  2: exists Ax, (P x y (z+1)).
  3: exists Ax, (P x (y+1) z).
  4: exists Ax, (P x (y+1) (z+1)).
  5: exists Ay, (P x y z).
  6: exists Ay, (P x y (z+1)).
  7: exists Ay, (P (x+1) y z).
  8: exists Ay, (P (x+1) y (z+1)).
  9: exists Az, (P x y z).
  10: exists Az, (P x (y+1) z).
  11: exists Az, (P (x+1) y z).
  12: exists Az, (P (x+1) (y+1) z).
  all: cbn [at_ nr px py pz]; split;
    [apply node_eq; cbn [at_ nr]; [f_equal; lia|reflexivity]|apply crossed_negb].
Qed.

Lemma crossed_same s d i c c' n n' : on_edge n -> on_edge n' -> move c n = move c' n' ->
  crossed (conf_of s d i c) n = crossed (conf_of s d i c') n'.
Proof.
  intros E E' M.
  destruct (crossed_samples s d i c n E) as (a & p & H & X).
  destruct (crossed_samples s d i c' n' E') as (a' & p' & H' & X').
  rewrite H, H' in M. apply edge_node_injective in M. destruct M as [<- <-].
  destruct (crossed (conf_of s d i c) n), (crossed (conf_of s d i c') n'); try reflexivity.
  - symmetry. apply X', X. reflexivity.
  - apply X, X'. reflexivity.
Qed.

Lemma edge_not_interior c c' n n' : on_edge n -> interior n' -> move c n = move c' n' -> False.
Proof.
  destruct c as [x y z], c' as [x' y' z'], n as [[nx ny nz] k], n' as [[nx' ny' nz'] k'].
  unfold on_edge, interior, even2, ncoord, coord, move. cbn [at_ nr px py pz].
  intros (_ & H) (-> & -> & ->) E.
  pose proof (f_equal (ncoord Ax) E) as X. pose proof (f_equal (ncoord Ay) E) as Y.
  pose proof (f_equal (ncoord Az) E) as Z. unfold ncoord, coord in X, Y, Z.
  cbn [at_ px py pz] in X, Y, Z. clear E. lia.
Qed.

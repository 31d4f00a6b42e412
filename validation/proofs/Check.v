(** * The conditions, as a computation on a table of tiles *)

From Coq Require Import ZArith NArith List Bool Relations Lia.
From Proofs Require Import Lattice Conditions Geometry Surface.
Import ListNotations.
Open Scope Z_scope.

(** ** Tables *)

(** A rule as its certificate has it. [table] has for each of the 256 signs, bit c of which says that
    corner c is inside, the decisions with their triangles; [asked] whether the rule decides there.
    Where it does not, the decision is 0. Nodes 0 .. 11 are those of lattice edges. *)
Definition numbered := (N * N * N)%type.
Record rule := Rule {
  bits : N;
  asked : list bool;
  table : list (list (N * list numbered));
  drawn : interface }.

Definition bit (b : bool) (n : N) : N := if b then n else 0%N.

Definition signs (k : conf) : N :=
  (bit (c000 k) 1 + bit (c100 k) 2 + bit (c010 k) 4 + bit (c110 k) 8
   + bit (c001 k) 16 + bit (c101 k) 32 + bit (c011 k) 64 + bit (c111 k) 128)%N.

(** Bit 2 a + side of a decision belongs to a face, further bits to the cell. *)
Definition face_bits (k : conf) : N :=
  (bit (lowx k) 1 + bit (highx k) 2 + bit (lowy k) 4 + bit (highy k) 8
   + bit (lowz k) 16 + bit (highz k) 32)%N.
Definition own_bits (R : rule) (k : conf) : N :=
  (N.land (face_bits k) (2 ^ bits R - 1) + 64 * inner k)%N.
Definition choices (R : rule) : N := (2 ^ (bits R - 6))%N.

Definition place (n : N) : node :=
  match n with
  | 0 => Node (P 1 0 0) 0 | 1 => Node (P 1 2 0) 0 | 2 => Node (P 1 0 2) 0 | 3 => Node (P 1 2 2) 0
  | 4 => Node (P 0 1 0) 0 | 5 => Node (P 2 1 0) 0 | 6 => Node (P 0 1 2) 0 | 7 => Node (P 2 1 2) 0
  | 8 => Node (P 0 0 1) 0 | 9 => Node (P 2 0 1) 0 | 10 => Node (P 0 2 1) 0 | 11 => Node (P 2 2 1) 0
  | _ => Node (P 1 1 1) (Z.of_N n - 12)
  end%N.
Definition edge_nodes : list node := map place [0; 1; 2; 3; 4; 5; 6; 7; 8; 9; 10; 11]%N.

Fixpoint find (decision : N) (l : list (N * list numbered)) : list numbered :=
  match l with
  | [] => []
  | (n, ts) :: m => if N.eqb n decision then ts else find decision m
  end.

Definition tile (R : rule) : tiles := fun k =>
  let n := N.to_nat (signs k) in
  let decision := if nth n (asked R) false then own_bits R k else 0%N in
  map (fun '(a, b, c) => (place a, place b, place c)) (find decision (nth n (table R) [])).

(** An interface from three lists, with an entry for each axis and kind of face; edges as numbers of
    nodes. *)
Definition kind (a : axis) (f : face) : nat :=
  N.to_nat (bit (f00 f) 1 + bit (f10 f) 2 + bit (f01 f) 4 + bit (f11 f) 8 + bit (decided f) 16
            + match a with Ax => 0 | Ay => 32 | Az => 64 end)%N.
Definition edges_at (l : list (list (N * N))) (a : axis) (f : face) : list edge :=
  map (fun '(m, n) => (place m, place n)) (nth (kind a f) l []).
Definition drawn_from (segs below above : list (list (N * N))) : interface :=
  Interface (edges_at segs) (edges_at below) (edges_at above).

(** ** Equality *)

(** Written with [if], so that a computation stops at the first difference. *)
Definition node_eqb (m n : node) : bool :=
  if Z.eqb (px (at_ m)) (px (at_ n)) then
    if Z.eqb (py (at_ m)) (py (at_ n)) then
      if Z.eqb (pz (at_ m)) (pz (at_ n)) then Z.eqb (nr m) (nr n) else false
    else false
  else false.
Definition edge_eqb (e f : edge) : bool :=
  if node_eqb (fst e) (fst f) then node_eqb (snd e) (snd f) else false.
Fixpoint mem (e : edge) (l : list edge) : bool :=
  match l with [] => false | f :: m => if edge_eqb e f then true else mem e m end.

Lemma node_eqb_eq m n : node_eqb m n = true <-> m = n.
Proof.
  destruct m as [[x y z] k], n as [[x' y' z'] k']. unfold node_eqb. cbn [at_ nr px py pz].
  destruct (Z.eqb_spec x x') as [->|]; [|split; congruence].
  destruct (Z.eqb_spec y y') as [->|]; [|split; congruence].
  destruct (Z.eqb_spec z z') as [->|]; [|split; congruence].
  rewrite Z.eqb_eq. split; congruence.
Qed.

Lemma edge_eqb_eq e f : edge_eqb e f = true <-> e = f.
Proof.
  destruct e as [a b], f as [a' b']. unfold edge_eqb. cbn [fst snd].
  destruct (node_eqb a a') eqn:E.
  - apply node_eqb_eq in E. subst a'. rewrite node_eqb_eq. split; congruence.
  - split; [discriminate|]. intros H. injection H. intros _ <-.
    rewrite <- E. apply node_eqb_eq. reflexivity.
Qed.

Lemma mem_In e l : mem e l = true <-> In e l.
Proof.
  induction l as [|f l IH]; cbn; [split; [discriminate|intros []]|].
  destruct (edge_eqb e f) eqn:E.
  - apply edge_eqb_eq in E. subst. tauto.
  - rewrite IH. split; [auto|]. intros [H|H]; [|exact H]. subst f. exfalso.
    assert (edge_eqb e e = true) by (apply edge_eqb_eq; reflexivity). congruence.
Qed.

Lemma mem_false e l : mem e l = false <-> ~ In e l.
Proof. rewrite <- mem_In. destruct (mem e l); intuition congruence. Qed.

Fixpoint nodup (l : list edge) : bool :=
  match l with [] => true | e :: m => if mem e m then false else nodup m end.

Lemma nodup_NoDup l : nodup l = true -> NoDup l.
Proof.
  induction l as [|e l IH]; cbn; [constructor|].
  destruct (mem e l) eqn:E; [discriminate|]. apply mem_false in E. constructor; auto.
Qed.

(** ** Walking round a node *)

Fixpoint node_mem (n : node) (l : list node) : bool :=
  match l with [] => false | m :: l => if node_eqb n m then true else node_mem n l end.

Lemma node_mem_In n l : node_mem n l = true <-> In n l.
Proof.
  induction l as [|m l IH]; cbn; [split; [discriminate|intros []]|].
  destruct (node_eqb n m) eqn:E.
  - apply node_eqb_eq in E. subst. tauto.
  - rewrite IH. split; [auto|]. intros [H|H]; [|exact H]. subst m. exfalso.
    assert (node_eqb n n = true) by (apply node_eqb_eq; reflexivity). congruence.
Qed.

Definition steps (v : node) (ts : list triangle) : list (node * node) :=
  flat_map (fun '(a, b, c) =>
    (if node_eqb v a then [(b, c)] else []) ++ (if node_eqb v b then [(c, a)] else [])
    ++ (if node_eqb v c then [(a, b)] else [])) ts.

Lemma in_steps v ts w x : In (w, x) (steps v ts) <-> corner ts v w x.
Proof.
  unfold steps, corner. rewrite in_flat_map. split.
  - intros ([[a b] c] & H & S). rewrite !in_app_iff in S.
    destruct S as [S|[S|S]].
    + destruct (node_eqb v a) eqn:E; [|contradiction]. apply node_eqb_eq in E. subst.
      destruct S as [S|[]]. injection S. intros; subst. auto.
    + destruct (node_eqb v b) eqn:E; [|contradiction]. apply node_eqb_eq in E. subst.
      destruct S as [S|[]]. injection S. intros; subst. auto.
    + destruct (node_eqb v c) eqn:E; [|contradiction]. apply node_eqb_eq in E. subst.
      destruct S as [S|[]]. injection S. intros; subst. auto.
  - assert (E : node_eqb v v = true) by (apply node_eqb_eq; reflexivity).
    intros [H|[H|H]]; eexists; (split; [exact H|]); cbn; rewrite E, !in_app_iff; cbn; auto.
Qed.

(** The nodes that are reached from [S] in one pass over the steps, either way. *)
Definition pass (L : list (node * node)) (S : list node) : list node :=
  fold_left (fun S '(a, b) =>
    if node_mem a S then b :: S else if node_mem b S then a :: S else S) L S.
Fixpoint reach (n : nat) (L : list (node * node)) (S : list node) : list node :=
  match n with O => S | S n => reach n L (pass L S) end.

Lemma pass_linked ts v w L : (forall a b, In (a, b) L -> corner ts v a b) ->
  forall S, (forall x, In x S -> linked ts v w x) ->
  forall x, In x (pass L S) -> linked ts v w x.
Proof.
  induction L as [|[a b] L IH]; intros HL S HS; [exact HS|].
  apply IH; [intros; apply HL; right; assumption|].
  assert (H : corner ts v a b) by (apply HL; left; reflexivity).
  cbn. destruct (node_mem a S) eqn:Ea; [|destruct (node_mem b S) eqn:Eb]; [| |exact HS].
  - apply node_mem_In in Ea. intros x [<-|X]; [|auto].
    eapply rst_trans; [apply HS, Ea|]. apply rst_step, H.
  - apply node_mem_In in Eb. intros x [<-|X]; [|auto].
    eapply rst_trans; [apply HS, Eb|]. apply rst_sym, rst_step, H.
Qed.

Lemma reach_linked ts v w L n : (forall a b, In (a, b) L -> corner ts v a b) ->
  forall S, (forall x, In x S -> linked ts v w x) ->
  forall x, In x (reach n L S) -> linked ts v w x.
Proof.
  intros HL. induction n as [|n IH]; intros S HS; [exact HS|].
  apply IH. apply pass_linked; assumption.
Qed.

Definition hangs_together (v : node) (ts : list triangle) : bool :=
  let L := steps v ts in
  match L with
  | [] => true
  | (a, b) :: _ =>
    let S := reach (length L) L [a] in
    forallb (fun '(x, y) => node_mem x S && node_mem y S) L
  end.

Lemma hangs_together_linked v ts : hangs_together v ts = true ->
  forall w w', around ts v w -> around ts v w' -> linked ts v w w'.
Proof.
  unfold hangs_together. intros H.
  assert (E : forall w, around ts v w -> exists x, In (w, x) (steps v ts) \/ In (x, w) (steps v ts)).
  { intros w (x & [A|A]); exists x; rewrite !in_steps; auto. }
  destruct (steps v ts) as [|[a b] L] eqn:Es.
  - intros w w' A. destruct (E w A) as (x & [[]|[]]).
  - rewrite forallb_forall in H.
    assert (Q : forall w, around ts v w -> linked ts v a w).
    { intros w A. apply (reach_linked ts v a ((a, b) :: L) (length ((a, b) :: L))) with (S := [a]).
      - intros c e M. rewrite <- Es in M. apply in_steps, M.
      - intros c [<-|[]]. apply rst_refl.
      - destruct (E w A) as (x & [M|M]); apply H in M; apply andb_true_iff in M;
          apply node_mem_In; tauto. }
    intros w w' A A'. eapply rst_trans; [apply rst_sym, Q, A|apply Q, A'].
Qed.

(** ** The conditions on one tile *)

Definition axes : list axis := [Ax; Ay; Az].
Lemma in_axes a : In a axes.
Proof. destruct a; cbn; auto. Qed.

Definition even2b (z : Z) : bool := Z.eqb z 0 || Z.eqb z 2.
Lemma even2b_even2 z : even2b z = true <-> even2 z.
Proof. unfold even2b, even2. rewrite orb_true_iff, !Z.eqb_eq. tauto. Qed.

Definition interiorb (n : node) : bool :=
  Z.eqb (ncoord Ax n) 1 && Z.eqb (ncoord Ay n) 1 && Z.eqb (ncoord Az n) 1.
Definition localb (n : node) : bool := node_mem n edge_nodes || interiorb n.

Lemma edge_nodes_on_edge n : In n edge_nodes <-> on_edge n.
Proof.
  split.
  - cbn. intros H. unfold on_edge, ncoord, coord, even2.
    repeat (destruct H as [H|H]; [subst n; cbn; auto 10|]). contradiction.
  - destruct n as [[x y z] k]. unfold on_edge, ncoord, coord, even2. cbn [at_ nr px py pz].
    intros [-> [(-> & [->| ->] & [->| ->])|[(-> & [->| ->] & [->| ->])|(-> & [->| ->] & [->| ->])]]];
      cbn; tauto.
Qed.

Lemma localb_local n : localb n = true -> local n.
Proof.
  unfold localb, local. rewrite orb_true_iff, node_mem_In, edge_nodes_on_edge.
  unfold interiorb, interior. rewrite !andb_true_iff, !Z.eqb_eq. tauto.
Qed.

Definition check_triangle (t : triangle) : bool :=
  let '(a, b, c) := t in
  localb a && localb b && localb c
  && negb (node_eqb a b) && negb (node_eqb b c) && negb (node_eqb c a).

Definition rightb (k : conf) (a : axis) (side : Z) (e : edge) : bool :=
  let p := at_ (fst e) in
  let inner_end := if sample k (low_end p) then low_end p else high_end p in
  Z.ltb (det (minus (at_ (snd e)) p) (minus inner_end p) (set a (side - 1) (P 0 0 0))) 0.

Definition on (a : axis) (side : Z) (e : edge) : bool :=
  Z.eqb (ncoord a (fst e)) side && Z.eqb (ncoord a (snd e)) side.

Lemma on_spec a side x y : on a side (x, y) = true <-> ncoord a x = side /\ ncoord a y = side.
Proof. unfold on. cbn [fst snd]. rewrite andb_true_iff, !Z.eqb_eq. tauto. Qed.

Definition check_segment (k : conf) (e : edge) : bool :=
  existsb (fun a => existsb (fun side => on a side e && rightb k a side e) [0; 2]) axes.

Definition eset (a : axis) (z : Z) (e : edge) : edge := (nset a z (fst e), nset a z (snd e)).

Definition check_below (I : interface) (k : conf) (D : list edge) (a : axis) : bool :=
  let f := high_face a k in
  let S := segments I a f in
  let Q := chords_below I a f in
  forallb (fun e => if on a 2 e then mem (eset a 0 e) (if mem (swap e) D then Q else S) else true) D
  && forallb (fun e => mem (eset a 2 e) D && negb (mem (swap (eset a 2 e)) D)) S.

Definition check_above (I : interface) (k : conf) (D : list edge) (a : axis) : bool :=
  let f := low_face a k in
  let S := segments I a f in
  let Q := chords_above I a f in
  forallb (fun e => if on a 0 e then
    if mem (swap e) D then mem e Q else mem (swap e) S else true) D
  && forallb (fun e => mem (swap e) D && negb (mem e D)) S.

Definition used (D : list edge) (v : node) : bool := existsb (fun e => node_eqb v (fst e)) D.

Definition check_ends (D : list edge) (v : node) : bool :=
  if used D v then
    forallb (fun a => if even2b (ncoord a v) then
      existsb (fun e => if node_eqb v (fst e) || node_eqb v (snd e)
        then on a (ncoord a v) e && negb (mem (swap e) D) else false) D else true) axes
  else true.

Definition check_tile (I : interface) (k : conf) (ts : list triangle) : bool :=
  let D := directed ts in
  forallb check_triangle ts
  && nodup D
  && forallb (fun v => eqb (used D v) (crossed k v)) edge_nodes
  && forallb (fun e => if mem (swap e) D then true else check_segment k e) D
  && forallb (check_below I k D) axes
  && forallb (check_above I k D) axes
  && forallb (fun e => hangs_together (fst e) ts) D
  && forallb (check_ends D) edge_nodes.

(** ** All cells and all faces *)

Definition bools : list bool := [false; true].
Definition options (b : bool) : list bool := if b then bools else [false].
Definition inners (n : N) : list N := map N.of_nat (seq 0 (N.to_nat n)).

Definition for_all_cells (n : N) (Q : conf -> bool) : bool :=
  let all := fun F => forallb F bools in
  all (fun b000 => all (fun b100 => all (fun b010 => all (fun b110 =>
  all (fun b001 => all (fun b101 => all (fun b011 => all (fun b111 =>
  forallb (fun lx => forallb (fun hx => forallb (fun ly => forallb (fun hy =>
  forallb (fun lz => forallb (fun hz => forallb (fun m =>
    Q (Conf b000 b100 b010 b110 b001 b101 b011 b111 lx hx ly hy lz hz m))
    (inners n))
    (options (ambiguous b001 b101 b011 b111))) (options (ambiguous b000 b100 b010 b110)))
    (options (ambiguous b010 b110 b011 b111))) (options (ambiguous b000 b100 b001 b101)))
    (options (ambiguous b100 b110 b101 b111))) (options (ambiguous b000 b010 b001 b011))
  )))))))).

Lemma in_bools b : In b bools.
Proof. destruct b; cbn; auto. Qed.

Lemma in_options b c : (b = true -> c = true) -> In b (options c).
Proof. destruct b, c; cbn; intros H; try discriminate (H eq_refl); auto. Qed.

Lemma for_all_cells_spec n Q : for_all_cells n Q = true -> forall k, possible n k -> Q k = true.
Proof.
  unfold for_all_cells. intros H k (L & U & M).
  pose proof (L Ax) as Lx. pose proof (L Ay) as Ly. pose proof (L Az) as Lz.
  pose proof (U Ax) as Ux. pose proof (U Ay) as Uy. pose proof (U Az) as Uz.
  destruct k as [b000 b100 b010 b110 b001 b101 b011 b111 lx hx ly hy lz hz m].
  unfold amb in *. cbn in Lx, Ly, Lz, Ux, Uy, Uz, M. clear L U.
  rewrite forallb_forall in H. specialize (H b000 (in_bools _)).
  rewrite forallb_forall in H. specialize (H b100 (in_bools _)).
  rewrite forallb_forall in H. specialize (H b010 (in_bools _)).
  rewrite forallb_forall in H. specialize (H b110 (in_bools _)).
  rewrite forallb_forall in H. specialize (H b001 (in_bools _)).
  rewrite forallb_forall in H. specialize (H b101 (in_bools _)).
  rewrite forallb_forall in H. specialize (H b011 (in_bools _)).
  rewrite forallb_forall in H. specialize (H b111 (in_bools _)).
  rewrite forallb_forall in H. specialize (H lx (in_options _ _ Lx)).
  rewrite forallb_forall in H. specialize (H hx (in_options _ _ Ux)).
  rewrite forallb_forall in H. specialize (H ly (in_options _ _ Ly)).
  rewrite forallb_forall in H. specialize (H hy (in_options _ _ Uy)).
  rewrite forallb_forall in H. specialize (H lz (in_options _ _ Lz)).
  rewrite forallb_forall in H. specialize (H hz (in_options _ _ Uz)).
  rewrite forallb_forall in H. apply H. unfold inners. apply in_map_iff.
  exists (N.to_nat m). split; [apply N2Nat.id|]. apply in_seq. lia.
Qed.

Definition check_face (I : interface) (a : axis) (f : face) : bool :=
  forallb (on a 0) (segments I a f)
  && forallb (fun e => negb (mem e (chords_above I a f))) (chords_below I a f).

Definition check_faces (I : interface) : bool :=
  forallb (fun a => forallb (fun b00 => forallb (fun b10 => forallb (fun b01 =>
  forallb (fun b11 => forallb (fun b => check_face I a (Face b00 b10 b01 b11 b))
    bools) bools) bools) bools) bools) axes.

Lemma check_faces_spec I : check_faces I = true -> forall a f, check_face I a f = true.
Proof.
  unfold check_faces. intros H a [b00 b10 b01 b11 b].
  rewrite forallb_forall in H. specialize (H a (in_axes _)).
  rewrite forallb_forall in H. specialize (H b00 (in_bools _)).
  rewrite forallb_forall in H. specialize (H b10 (in_bools _)).
  rewrite forallb_forall in H. specialize (H b01 (in_bools _)).
  rewrite forallb_forall in H. specialize (H b11 (in_bools _)).
  rewrite forallb_forall in H. apply H, in_bools.
Qed.

Definition check (R : rule) : bool :=
  check_faces (drawn R)
  && for_all_cells (choices R) (fun k => check_tile (drawn R) k (tile R k)).

(** ** A table that passes satisfies the conditions *)

Lemma used_around D ts v : D = directed ts -> used D v = true <-> exists w, around ts v w.
Proof.
  intros ->. unfold used. rewrite existsb_exists. split.
  - intros ([x y] & H & E). apply node_eqb_eq in E. cbn in E. subst x.
    exists y. apply around_directed. auto.
  - intros (w & (x & [H|H])); apply corner_directed in H; destruct H as (H & _ & _);
      eexists; (split; [exact H|]); apply node_eqb_eq; reflexivity.
Qed.

Section Sound.

Variable R : rule.
Hypothesis passes : check R = true.
Let I := drawn R.

Lemma faces_pass a f : check_face I a f = true.
Proof. apply check_faces_spec. unfold check in passes. apply andb_true_iff in passes. apply passes. Qed.

Lemma tile_passes k : possible (choices R) k -> check_tile I k (tile R k) = true.
Proof.
  intros H. unfold check in passes. apply andb_true_iff in passes.
  apply (for_all_cells_spec (choices R) (fun k => check_tile I k (tile R k))); [apply passes|exact H].
Qed.

Ltac part k H :=
  let W := fresh in
  pose proof (tile_passes k H) as W; unfold check_tile in W; rewrite !andb_true_iff in W;
  destruct W as (((((((W1 & W2) & W3) & W4) & W5) & W6) & W7) & W8);
  rewrite forallb_forall in W1, W3, W4, W5, W6, W7, W8.

Theorem conditions_hold : conditions (choices R) (tile R) I.
Proof.
  constructor.
  - (* nodes_local *)
    intros k H a b c T. part k H. specialize (W1 _ T). unfold check_triangle in W1.
    rewrite !andb_true_iff, !negb_true_iff in W1.
    destruct W1 as (((((La & Lb) & Lc) & N1) & N2) & N3).
    split; [auto using localb_local|].
    repeat split; intros E; subst;
      [rewrite (proj2 (node_eqb_eq b b)) in N1 by reflexivity; discriminate
      |rewrite (proj2 (node_eqb_eq c c)) in N2 by reflexivity; discriminate
      |rewrite (proj2 (node_eqb_eq a a)) in N3 by reflexivity; discriminate].
  - (* once *)
    intros k H. part k H. apply nodup_NoDup, W2.
  - (* nodes_crossed *)
    intros k H n E. part k H. apply edge_nodes_on_edge in E. specialize (W3 _ E).
    apply eqb_prop in W3. rewrite <- W3, <- (used_around (directed (tile R k))); [tauto|reflexivity].
  - (* segments_on_faces *)
    intros k H e M N. part k H. specialize (W4 _ M). apply mem_false in N. rewrite N in W4.
    cbn iota in W4. unfold check_segment in W4. apply existsb_exists in W4.
    destruct W4 as (a & _ & W4). apply existsb_exists in W4. destruct W4 as (side & S & W4).
    apply andb_true_iff in W4. destruct W4 as [O Q]. destruct e as [x y].
    apply on_spec in O. exists a, side. cbn [fst snd].
    split; [cbn in S; unfold even2; intuition auto|]. split; [apply O|]. split; [apply O|].
    unfold rightb in Q. apply Z.ltb_lt in Q. exact Q.
  - (* flat *)
    intros a f [x y] H. pose proof (faces_pass a f) as W. unfold check_face in W.
    apply andb_true_iff in W. destruct W as [W _]. rewrite forallb_forall in W.
    apply W in H. apply on_spec in H. exact H.
  - (* below_segments *)
    intros k H a x y Hx Hy M N. part k H. specialize (W5 a (in_axes a)).
    unfold check_below in W5. apply andb_true_iff in W5. destruct W5 as [W5 _].
    rewrite forallb_forall in W5. specialize (W5 _ M).
    rewrite (proj2 (on_spec a 2 x y) (conj Hx Hy)) in W5. cbn iota in W5.
    change (swap (x, y)) with (y, x) in W5. apply mem_false in N. rewrite N in W5.
    apply mem_In in W5. exact W5.
  - (* below_has *)
    intros k H a x y M. part k H. specialize (W5 a (in_axes a)).
    unfold check_below in W5. apply andb_true_iff in W5. destruct W5 as [_ W5].
    rewrite forallb_forall in W5. specialize (W5 _ M).
    rewrite andb_true_iff, negb_true_iff, mem_In, mem_false in W5. exact W5.
  - (* above_segments *)
    intros k H a x y Hx Hy M N. part k H. specialize (W6 a (in_axes a)).
    unfold check_above in W6. apply andb_true_iff in W6. destruct W6 as [W6 _].
    rewrite forallb_forall in W6. specialize (W6 _ M).
    rewrite (proj2 (on_spec a 0 x y) (conj Hx Hy)) in W6. cbn iota in W6.
    change (swap (x, y)) with (y, x) in W6. apply mem_false in N. rewrite N in W6.
    apply mem_In in W6. exact W6.
  - (* above_has *)
    intros k H a x y M. part k H. specialize (W6 a (in_axes a)).
    unfold check_above in W6. apply andb_true_iff in W6. destruct W6 as [_ W6].
    rewrite forallb_forall in W6. specialize (W6 _ M).
    rewrite andb_true_iff, negb_true_iff, mem_In, mem_false in W6. exact W6.
  - (* below_chords *)
    intros k H a x y Hx Hy M N. part k H. specialize (W5 a (in_axes a)).
    unfold check_below in W5. apply andb_true_iff in W5. destruct W5 as [W5 _].
    rewrite forallb_forall in W5. specialize (W5 _ M).
    rewrite (proj2 (on_spec a 2 x y) (conj Hx Hy)) in W5. cbn iota in W5.
    change (swap (x, y)) with (y, x) in W5. apply mem_In in N. rewrite N in W5.
    apply mem_In in W5. exact W5.
  - (* above_chords *)
    intros k H a x y Hx Hy M N. part k H. specialize (W6 a (in_axes a)).
    unfold check_above in W6. apply andb_true_iff in W6. destruct W6 as [W6 _].
    rewrite forallb_forall in W6. specialize (W6 _ M).
    rewrite (proj2 (on_spec a 0 x y) (conj Hx Hy)) in W6. cbn iota in W6.
    change (swap (x, y)) with (y, x) in W6. apply mem_In in N. rewrite N in W6.
    apply mem_In in W6. exact W6.
  - (* chords_apart *)
    intros a f e H. pose proof (faces_pass a f) as W. unfold check_face in W.
    apply andb_true_iff in W. destruct W as [_ W]. rewrite forallb_forall in W.
    apply W in H. apply negb_true_iff, mem_false in H. exact H.
  - (* one_fan *)
    intros k H v w w' A. part k H.
    assert (U : exists e, In e (directed (tile R k)) /\ fst e = v).
    { destruct A as (x & [A|A]); apply corner_directed in A; destruct A as (A & _ & _);
        eexists; (split; [exact A|reflexivity]). }
    destruct U as (e & U & <-). revert A. specialize (W7 _ U).
    intros A A'. eapply hangs_together_linked; eauto.
  - (* fan_ends *)
    intros k H v w E A a Ev. part k H. apply edge_nodes_on_edge in E.
    specialize (W8 _ E). unfold check_ends in W8.
    rewrite (proj2 (used_around (directed (tile R k)) (tile R k) v eq_refl)) in W8 by eauto.
    cbn iota in W8. rewrite forallb_forall in W8. specialize (W8 a (in_axes a)).
    apply even2b_even2 in Ev. rewrite Ev in W8. cbn iota in W8. apply existsb_exists in W8.
    destruct W8 as ([x y] & M & W8).
    destruct (node_eqb v (fst (x, y)) || node_eqb v (snd (x, y))) eqn:V; [|discriminate].
    rewrite andb_true_iff, negb_true_iff in W8. rewrite orb_true_iff in V.
    destruct W8 as [O N]. apply on_spec in O. apply mem_false in N.
    change (swap (x, y)) with (y, x) in N. cbn in V. rewrite !node_eqb_eq in V.
    destruct V as [<-|<-]; [exists y|exists x]; intuition auto.
Qed.

End Sound.

(** What remains for each rule is to compute [check]. *)
Theorem checked_rule : forall R, check R = true -> makes_surfaces (choices R) (tile R).
Proof. intros R H. apply conditions_suffice with (drawn R). apply conditions_hold, H. Qed.

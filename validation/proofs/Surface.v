(** * Tiles that satisfy the local conditions make a surface on every finite lattice *)

From Coq Require Import ZArith NArith List Bool Relations Lia.
From Proofs Require Import Lattice Conditions Geometry Circle.
Import ListNotations.
Open Scope Z_scope.

Section Mesh.

(** Any rule that satisfies the conditions; any field: samples, decisions on faces and in cells; any
    finite lattice. *)
Variables (choices : N) (T : tiles) (I : interface).
Hypothesis C : conditions choices T I.
Variables (s : samples) (d : face_decisions) (i : cell_decisions).
Hypothesis in_choices : forall c, (i c < choices)%N.
Variables nx ny nz : nat.

Let K c := conf_of s d i c.
Let cells := box nx ny nz.
Let M := mesh T s d i cells.

Lemma possible_K c : possible choices (K c).
Proof.
  unfold K. destruct c as [x y z]. repeat split; [| |apply in_choices];
    intros a; destruct a; cbn; intros H; apply andb_prop in H; apply H.
Qed.
Local Hint Resolve possible_K : core.

(** Both cells at a face see the same of it. *)
Lemma same_face a c : high_face a (K c) = low_face a (K (up a c)).
Proof. unfold K. destruct a, c as [x y z]; reflexivity. Qed.

Lemma tile_local c x y : In (x, y) (directed (T (K c))) -> local x /\ local y /\ x <> y.
Proof.
  intros (p & q & r & H & S)%in_directed.
  apply (nodes_local _ _ _ C _ (possible_K c)) in H.
  destruct H as ((Lp & Lq & Lr) & N1 & N2 & N3).
  destruct S as [[-> ->]|[[-> ->]|[-> ->]]]; auto.
Qed.

Lemma in_mesh a b t :
  In (a, b, t) M <-> exists c, In c cells /\ exists p q r,
    In (p, q, r) (T (K c)) /\ a = move c p /\ b = move c q /\ t = move c r.
Proof.
  unfold M, mesh. rewrite in_flat_map. split.
  - intros (c & Hc & H). apply in_map_iff in H. destruct H as ([[p q] r] & E & H).
    exists c. split; [exact Hc|]. exists p, q, r. split; [exact H|].
    unfold move_triangle in E. injection E. intros <- <- <-. auto.
  - intros (c & Hc & p & q & r & H & -> & -> & ->). exists c. split; [exact Hc|].
    apply in_map_iff. exists (p, q, r). auto.
Qed.

Lemma in_directed_mesh a b :
  In (a, b) (directed M) <-> exists c, In c cells /\ exists p q,
    In (p, q) (directed (T (K c))) /\ a = move c p /\ b = move c q.
Proof.
  rewrite in_directed. split.
  - intros (a' & b' & t' & H & S). apply in_mesh in H.
    destruct H as (c & Hc & p & q & r & H & -> & -> & ->). exists c. split; [exact Hc|].
    destruct S as [[-> ->]|[[-> ->]|[-> ->]]].
    + exists p, q. split; [|auto]. apply in_directed. exists p, q, r. auto.
    + exists q, r. split; [|auto]. apply in_directed. exists p, q, r. auto.
    + exists r, p. split; [|auto]. apply in_directed. exists p, q, r. auto.
  - intros (c & Hc & p & q & H & -> & ->). apply in_directed in H.
    destruct H as (p' & q' & r' & H & S).
    exists (move c p'), (move c q'), (move c r'). split.
    + apply in_mesh. exists c. split; [exact Hc|]. exists p', q', r'. auto.
    + destruct S as [[-> ->]|[[-> ->]|[-> ->]]]; auto.
Qed.

Lemma in_directed_dec e l : In (e : edge) l \/ ~ In e l.
Proof.
  assert (D : forall m n : node, {m = n} + {m <> n}).
  { repeat decide equality. }
  assert (E : forall m n : edge, {m = n} + {m <> n}).
  { decide equality; apply D. }
  destruct (in_dec E e l); auto.
Qed.

(** ** No directed edge occurs twice *)

(** The cell below a face and the cell above it never have one directed edge. *)
Lemma below_not_above c a x y :
  ncoord a x = 2 -> ncoord a y = 2 -> In (x, y) (directed (T (K c))) ->
  ~ In (nset a 0 x, nset a 0 y) (directed (T (K (up a c)))).
Proof.
  intros Hx Hy H H'.
  pose proof (ncoord_nset a 0 x) as Zx. pose proof (ncoord_nset a 0 y) as Zy.
  destruct (in_directed_dec (y, x) (directed (T (K c)))) as [R|R];
  destruct (in_directed_dec (nset a 0 y, nset a 0 x) (directed (T (K (up a c))))) as [R'|R'].
  - apply (chords_apart _ _ _ C a (high_face a (K c)) (nset a 0 x, nset a 0 y)).
    + apply (below_chords _ _ _ C); auto.
    + rewrite same_face. apply (above_chords _ _ _ C); auto.
  - apply (above_segments _ _ _ C _ (possible_K (up a c)) a) in H'; auto. rewrite <- same_face in H'.
    apply (below_has _ _ _ C _ (possible_K c) a) in H'; auto. destruct H' as [_ H'].
    rewrite !nset_nset, !nset_same in H' by assumption. contradiction.
  - apply (below_segments _ _ _ C _ (possible_K c) a) in H; auto. rewrite same_face in H.
    apply (above_has _ _ _ C _ (possible_K (up a c)) a) in H; auto. destruct H as [_ H]. contradiction.
  - apply (below_segments _ _ _ C _ (possible_K c) a) in H; auto. rewrite same_face in H.
    apply (above_has _ _ _ C _ (possible_K (up a c)) a) in H; auto. destruct H as [_ H]. contradiction.
Qed.

(** A directed edge of the mesh belongs to one cell. *)
Lemma one_cell c c' p q p' q' :
  In (p, q) (directed (T (K c))) -> In (p', q') (directed (T (K c'))) ->
  move c p = move c' p' -> move c q = move c' q' -> c = c'.
Proof.
  intros H H' Ep Eq.
  destruct (tile_local _ _ _ H) as (Lp & Lq & D). destruct (tile_local _ _ _ H') as (Lp' & Lq' & _).
  destruct (two_nodes _ _ _ _ _ _ Lp Lq Lp' Lq' D Ep Eq)
    as [E|[(a & -> & X & Y & -> & ->)|(a & -> & X & Y & -> & ->)]].
  - exact E.
  - exfalso. apply (below_not_above c a p q); assumption.
  - exfalso. apply (below_not_above c' a p' q'); assumption.
Qed.

Lemma directed_mesh : directed M =
  flat_map (fun c => map (fun e => (move c (fst e), move c (snd e))) (directed (T (K c)))) cells.
Proof.
  unfold M, mesh. induction cells as [|c l IH]; [reflexivity|]. simpl. rewrite <- IH.
  unfold directed. rewrite flat_map_app. f_equal. fold (K c).
  induction (T (K c)) as [|[[p q] r] ts IHt]; [reflexivity|]. simpl. rewrite IHt. reflexivity.
Qed.

Theorem mesh_oriented : NoDup (directed M).
Proof.
  rewrite directed_mesh. apply NoDup_flat_map.
  - apply NoDup_box.
  - intros c _. apply NoDup_map_injective; [|apply (once _ _ _ C); auto].
    intros [p q] [p' q'] E.
    pose proof (f_equal fst E) as E1. pose proof (f_equal snd E) as E2. cbn [fst snd] in E1, E2.
    apply move_injective in E1. apply move_injective in E2. congruence.
  - intros c c' e _ _ H H'. apply in_map_iff in H. apply in_map_iff in H'.
    destruct H as ([p q] & <- & H), H' as ([p' q'] & E & H').
    pose proof (f_equal fst E) as E1. pose proof (f_equal snd E) as E2. cbn [fst snd] in E1, E2.
    symmetry in E1, E2.
    eapply one_cell; eauto.
Qed.

(** ** The surface is closed *)

Lemma in_cells_up a c : In c cells -> ~ In (up a c) cells -> coord a c + 1 = size nx ny nz a.
Proof.
  unfold cells. rewrite !in_box. intros H H'.
  pose proof (H a) as Ha.
  destruct (Z.eq_dec (coord a c + 1) (size nx ny nz a)) as [E|E]; [exact E|].
  exfalso. apply H'. intros b. specialize (H b).
  destruct a, b, c as [x y z]; cbn [up set coord px py pz] in *; lia.
Qed.

Lemma in_cells_down a c : In (up a c) cells -> ~ In c cells -> coord a (up a c) = 0.
Proof.
  unfold cells. rewrite !in_box. intros H H'.
  destruct (Z.eq_dec (coord a (up a c)) 0) as [E|E]; [exact E|].
  exfalso. apply H'. intros b. pose proof (H a) as Ha. specialize (H b).
  destruct a, b, c as [x y z]; cbn [up set coord px py pz] in *; lia.
Qed.

Lemma in_cells_dec c : In c cells \/ ~ In c cells.
Proof.
  assert (D : forall p q : point, {p = q} + {p <> q}) by repeat decide equality.
  destruct (in_dec D c cells); auto.
Qed.

Definition down (a : axis) (c : point) : point := set a (coord a c - 1) c.
Lemma up_down a c : up a (down a c) = c.
Proof. destruct a, c as [x y z]; unfold up, down, set, coord; cbn [px py pz]; f_equal; lia. Qed.

Lemma ncoord_move a c n : ncoord a (move c n) = ncoord a n + 2 * coord a c.
Proof. destruct a, c, n as [[x y z] k]; reflexivity. Qed.

(** A segment of a cell, on a face with a second cell, occurs there in the other direction. *)
Lemma segment_above a c p q :
  ncoord a p = 2 -> ncoord a q = 2 -> In (p, q) (directed (T (K c))) ->
  ~ In (q, p) (directed (T (K c))) ->
  In (nset a 0 q, nset a 0 p) (directed (T (K (up a c)))) /\
  ~ In (nset a 0 p, nset a 0 q) (directed (T (K (up a c)))).
Proof.
  intros Hp Hq H R. apply (below_segments _ _ _ C _ (possible_K c) a) in H; auto.
  rewrite same_face in H. apply (above_has _ _ _ C _ (possible_K (up a c)) a) in H; auto.
Qed.

Lemma segment_below a c p q :
  ncoord a p = 0 -> ncoord a q = 0 -> In (p, q) (directed (T (K (up a c)))) ->
  ~ In (q, p) (directed (T (K (up a c)))) ->
  In (nset a 2 q, nset a 2 p) (directed (T (K c))) /\
  ~ In (nset a 2 p, nset a 2 q) (directed (T (K c))).
Proof.
  intros Hp Hq H R. apply (above_segments _ _ _ C _ (possible_K (up a c)) a) in H; auto.
  rewrite <- same_face in H. apply (below_has _ _ _ C _ (possible_K c) a) in H; auto.
Qed.

Theorem mesh_closed : forall e, In e (directed M) -> ~ edge_in_border nx ny nz e ->
  In (swap e) (directed M).
Proof.
  intros [a b] H B. apply in_directed_mesh in H. destruct H as (c & Hc & p & q & H & -> & ->).
  unfold swap. cbn [fst snd].
  destruct (in_directed_dec (q, p) (directed (T (K c)))) as [R|R].
  { apply in_directed_mesh. exists c. split; [exact Hc|]. exists q, p. auto. }
  destruct (segments_on_faces _ _ _ C _ (possible_K c) (p, q) H R)
    as (x & side & E & Hp & Hq & _). cbn [fst snd] in Hp, Hq.
  destruct E as [-> | ->].
  - rewrite <- (up_down x c) in H, R, Hc |- *.
    destruct (in_cells_dec (down x c)) as [Hd|Hd].
    + apply segment_below in H; auto. destruct H as [H _].
      apply in_directed_mesh. exists (down x c). split; [exact Hd|].
      exists (nset x 2 q), (nset x 2 p). split; [exact H|].
      rewrite !move_up' by assumption. auto.
    + exfalso. apply B. exists x. left. cbn [fst snd]. rewrite !ncoord_move.
      apply in_cells_down in Hc; auto. rewrite (up_down x c) in Hc. lia.
  - destruct (in_cells_dec (up x c)) as [Hu|Hu].
    + apply segment_above with (a := x) in H; auto. destruct H as [H _].
      apply in_directed_mesh. exists (up x c). split; [exact Hu|].
      exists (nset x 0 q), (nset x 0 p). split; [exact H|].
      rewrite !move_up by assumption. auto.
    + exfalso. apply B. exists x. right. cbn [fst snd]. rewrite !ncoord_move.
      apply in_cells_up in Hu; auto. lia.
Qed.

(** ** The triangles at a vertex are one fan *)

Lemma corner_move c v w x : In c cells -> corner (T (K c)) v w x ->
  corner M (move c v) (move c w) (move c x).
Proof.
  intros Hc [H|[H|H]]; [left|right; left|right; right]; apply in_mesh; exists c;
    (split; [exact Hc|]); eauto 10.
Qed.

Lemma corner_from_cell v w x : corner M v w x ->
  exists c, In c cells /\ exists v' w' x', corner (T (K c)) v' w' x' /\
    v = move c v' /\ w = move c w' /\ x = move c x'.
Proof.
  intros [H|[H|H]]; apply in_mesh in H; destruct H as (c & Hc & p & q & r & H & E1 & E2 & E3);
    exists c; (split; [exact Hc|]).
  - exists p, q, r. unfold corner. auto.
  - exists q, r, p. unfold corner. auto.
  - exists r, p, q. unfold corner. auto.
Qed.

Lemma around_move c v w : In c cells -> around (T (K c)) v w -> around M (move c v) (move c w).
Proof. intros Hc (x & [H|H]); exists (move c x); [left|right]; apply corner_move; auto. Qed.

Lemma around_from_cell v w : around M v w ->
  exists c, In c cells /\ exists v' w', around (T (K c)) v' w' /\ v = move c v' /\ w = move c w'.
Proof.
  intros (x & [H|H]); apply corner_from_cell in H;
    destruct H as (c & Hc & v' & w' & x' & H & E1 & E2 & E3); exists c; (split; [exact Hc|]).
  - exists v', w'. split; [exists x'; auto|auto].
  - exists v', x'. split; [exists w'; auto|auto].
Qed.

Lemma linked_move c v w w' : In c cells -> linked (T (K c)) v w w' ->
  linked M (move c v) (move c w) (move c w').
Proof.
  intros Hc. induction 1 as [w w' H| |w w' _ IH|w w' w'' _ IH _ IH'].
  - apply rst_step, corner_move; auto.
  - apply rst_refl.
  - apply rst_sym, IH.
  - eapply rst_trans; eauto.
Qed.

(** What stands round a node in one cell. *)
Definition stands (c : point) (v w : node) : Prop :=
  exists v' w', around (T (K c)) v' w' /\ v = move c v' /\ w = move c w'.

Lemma stands_linked c v w w' : In c cells -> stands c v w -> stands c v w' -> linked M v w w'.
Proof.
  intros Hc (v1 & w1 & H1 & -> & ->) (v2 & w2 & H2 & E & ->).
  apply move_injective in E. subst v2. apply linked_move; [exact Hc|].
  apply (one_fan _ _ _ C); auto.
Qed.

Lemma around_local c v w : around (T (K c)) v w -> local v.
Proof.
  intros [H|H]%around_directed; apply tile_local in H; tauto.
Qed.

Lemma local_on_edge v a : local v -> ncoord a v <> 1 -> on_edge v.
Proof. unfold local, interior. intros [H|H]; [auto|]. destruct a; tauto. Qed.

(** Two cells at a face have a common neighbour of a node on this face, if one of them has any. *)
Lemma common_above a c v w : In c cells -> In (up a c) cells ->
  around (T (K c)) v w -> ncoord a v = 2 ->
  exists u, stands c (move c v) u /\ stands (up a c) (move c v) u.
Proof.
  intros Hc Hu A V.
  assert (E : on_edge v) by (apply (local_on_edge v a); [eapply around_local; eauto|lia]).
  destruct (fan_ends _ _ _ C _ (possible_K c) v w E A a) as (u & U & S); [right; exact V|].
  rewrite V in U. exists (move c u).
  assert (A' : around (T (K c)) v u) by (apply around_directed; tauto).
  split; [exists v, u; auto|].
  exists (nset a 0 v), (nset a 0 u). rewrite !move_up by assumption. split; [|auto].
  apply around_directed. destruct S as [[S R]|[S R]].
  - right. eapply segment_above; eauto.
  - left. eapply segment_above; eauto.
Qed.

Lemma common_below a c v w : In c cells -> In (up a c) cells ->
  around (T (K (up a c))) v w -> ncoord a v = 0 ->
  exists u, stands c (move (up a c) v) u /\ stands (up a c) (move (up a c) v) u.
Proof.
  intros Hc Hu A V.
  assert (E : on_edge v) by (apply (local_on_edge v a); [eapply around_local; eauto|lia]).
  destruct (fan_ends _ _ _ C _ (possible_K (up a c)) v w E A a) as (u & U & S); [left; exact V|].
  rewrite V in U. exists (move (up a c) u).
  assert (A' : around (T (K (up a c))) v u) by (apply around_directed; tauto).
  split; [|exists v, u; auto].
  exists (nset a 2 v), (nset a 2 u). rewrite !move_up' by assumption. split; [|auto].
  apply around_directed. destruct S as [[S R]|[S R]].
  - right. eapply segment_below; eauto.
  - left. eapply segment_below; eauto.
Qed.

(** One step from cell to cell keeps what stands round a node linked. *)
Definition meets (c : point) (v : node) : Prop := exists w, stands c v w.

Definition joined (c c' : point) (v : node) : Prop :=
  meets c' v /\ forall w w', stands c v w -> stands c' v w' -> linked M v w w'.

Lemma joined_by c c' v u : In c cells -> In c' cells ->
  stands c v u -> stands c' v u -> joined c c' v.
Proof.
  intros Hc Hc' S S'. split; [exists u; exact S'|]. intros w w' W W'.
  apply rst_trans with u; [apply (stands_linked c)|apply (stands_linked c')]; assumption.
Qed.

Lemma step_up a c v : In c cells -> In (up a c) cells -> meets c v ->
  ncoord a v = 2 * (coord a c + 1) -> joined c (up a c) v.
Proof.
  intros Hc Hu (w & v' & w' & A & -> & ->) V. rewrite ncoord_move in V.
  destruct (common_above a c v' w' Hc Hu A) as (u & S & S'); [lia|].
  apply joined_by with u; assumption.
Qed.

Lemma step_down a c v : In c cells -> In (up a c) cells -> meets (up a c) v ->
  ncoord a v = 2 * (coord a c + 1) -> joined (up a c) c v.
Proof.
  intros Hc Hu (w & v' & w' & A & -> & ->) V. rewrite ncoord_move in V.
  destruct (common_below a c v' w' Hc Hu A) as (u & S & S').
  - destruct a, c as [x y z]; unfold up, set, coord in V; cbn [px py pz] in V; lia.
  - apply joined_by with u; assumption.
Qed.


Lemma joined_trans c c' c'' v : joined c c' v -> joined c' c'' v -> joined c c'' v.
Proof.
  intros [[u U] J] [Mt J']. split; [exact Mt|]. intros w w' W W'.
  apply rst_trans with u; [apply J|apply J']; assumption.
Qed.

(** A step along one axis, to the same place, up or down. *)
Lemma step a c x v : In c cells -> In (set a x c) cells -> meets c v ->
  x = coord a c \/ (x = coord a c + 1 /\ ncoord a v = 2 * x) \/
    (coord a c = x + 1 /\ ncoord a v = 2 * (x + 1)) ->
  joined c (set a x c) v.
Proof.
  intros Hc Hx Mt [E|[[E V]|[E V]]].
  - assert (Es : set a x c = c) by (destruct a, c; cbn in *; congruence).
    rewrite Es. destruct Mt as [u U]. apply joined_by with u; assumption.
  - subst x. apply step_up; assumption.
  - assert (Es : c = up a (set a x c)).
    { destruct a, c as [cx cy cz]; unfold up, set, coord in *; cbn [px py pz] in *; congruence. }
    assert (Ex : coord a (set a x c) = x) by (destruct a; reflexivity).
    rewrite Es at 1. apply step_down; [exact Hx|rewrite <- Es; exact Hc|rewrite <- Es; exact Mt|].
    rewrite Ex. exact V.
Qed.

(** Along each axis two cells with one node are in one place or next to it. *)
Lemma one_node_axis a c c' v v' : local v -> local v' -> move c v = move c' v' ->
  coord a c' = coord a c \/
  (coord a c' = coord a c + 1 /\ ncoord a (move c v) = 2 * coord a c') \/
  (coord a c = coord a c' + 1 /\ ncoord a (move c v) = 2 * (coord a c' + 1)).
Proof.
  intros L L' E. apply (f_equal (ncoord a)) in E. rewrite !ncoord_move in *.
  apply local_range in L. apply local_range in L'. destruct a; lia.
Qed.

Lemma meet_joined c c' v : In c cells -> In c' cells -> meets c v -> meets c' v -> joined c c' v.
Proof.
  intros Hc Hc' Mt Mt'.
  assert (A : forall a, coord a c' = coord a c \/
    (coord a c' = coord a c + 1 /\ ncoord a v = 2 * coord a c') \/
    (coord a c = coord a c' + 1 /\ ncoord a v = 2 * (coord a c' + 1))).
  { intros a. destruct Mt as (w & v1 & w1 & H1 & -> & _), Mt' as (w' & v2 & w2 & H2 & E & _).
    apply one_node_axis with v2; [eapply around_local; eauto|eapply around_local; eauto|exact E]. }
  clear Mt'. destruct c as [x y z], c' as [x' y' z'].
  unfold cells in *. rewrite in_box in Hc, Hc'.
  pose proof (Hc Ax). pose proof (Hc Ay). pose proof (Hc Az).
  pose proof (Hc' Ax). pose proof (Hc' Ay). pose proof (Hc' Az).
  pose proof (A Ax) as AX. pose proof (A Ay) as AY. pose proof (A Az) as AZ.
  cbn [coord px py pz] in *. clear A.
  assert (J1 : joined (P x y z) (P x' y z) v).
  { apply (step Ax (P x y z) x' v); try assumption; apply in_box; intros []; cbn; assumption. }
  assert (J2 : joined (P x' y z) (P x' y' z) v).
  { apply (step Ay (P x' y z) y' v); try assumption; [| |apply J1];
      apply in_box; intros []; cbn; assumption. }
  assert (J3 : joined (P x' y' z) (P x' y' z') v).
  { apply (step Az (P x' y' z) z' v); try assumption; [| |apply J2];
      apply in_box; intros []; cbn; assumption. }
  eapply joined_trans; [exact J1|]. eapply joined_trans; [exact J2|exact J3].
Qed.

Lemma around_stands v w : around M v w -> exists c, In c cells /\ stands c v w.
Proof.
  intros H. apply around_from_cell in H. destruct H as (c & Hc & v' & w' & H & E & E').
  exists c. split; [exact Hc|]. exists v', w'. auto.
Qed.

Theorem mesh_one_fan : forall v w w', around M v w -> around M v w' -> linked M v w w'.
Proof.
  intros v w w' H H'. apply around_stands in H. apply around_stands in H'.
  destruct H as (c & Hc & H), H' as (c' & Hc' & H').
  apply (meet_joined c c'); [exact Hc|exact Hc'|exists w; exact H|exists w'; exact H'|exact H|exact H'].
Qed.

(** Round a vertex each neighbour has one next at most, and one before it. *)
Lemma mesh_proper a b : In (a, b) (directed M) -> a <> b.
Proof.
  intros H. apply in_directed_mesh in H. destruct H as (c & _ & p & q & H & -> & ->).
  intros E. apply move_injective in E. apply tile_local in H. tauto.
Qed.

Lemma one_triangle t t' e : In t M -> In t' M -> In e (sides t) -> In e (sides t') -> t = t'.
Proof. apply in_flat_map_once, mesh_oriented. Qed.

Theorem mesh_one_next : forall v w x x', corner M v w x -> corner M v w x' -> x = x'.
Proof.
  intros v w x x' H H'.
  pose proof (corner_directed _ _ _ _ H) as (D & D1 & D2).
  pose proof (corner_directed _ _ _ _ H') as (_ & D1' & D2').
  apply mesh_proper in D, D1, D2, D1', D2'.
  destruct H as [H|[H|H]], H' as [H'|[H'|H']];
    pose proof (one_triangle _ _ (v, w) H H') as E; cbn in E;
    (specialize (E ltac:(auto) ltac:(auto))); congruence.
Qed.

Theorem mesh_one_before : forall v w w' x, corner M v w x -> corner M v w' x -> w = w'.
Proof.
  intros v w w' x H H'.
  pose proof (corner_directed _ _ _ _ H) as (D & D1 & D2).
  pose proof (corner_directed _ _ _ _ H') as (D' & D1' & _).
  apply mesh_proper in D, D1, D2, D', D1'.
  destruct H as [H|[H|H]], H' as [H'|[H'|H']];
    pose proof (one_triangle _ _ (x, v) H H') as E; cbn in E;
    (specialize (E ltac:(auto) ltac:(auto))); congruence.
Qed.

Lemma border_edge v w : edge_in_border nx ny nz (v, w) -> in_border nx ny nz v /\ in_border nx ny nz w.
Proof. intros (a & [[H H']|[H H']]); split; exists a; auto. Qed.

(** Off the border the neighbours of a vertex are a circle of different nodes, and its triangles are
    those that lead from one to the next. *)
Theorem mesh_full_turn : forall v w, around M v w -> ~ in_border nx ny nz v ->
  exists circle, NoDup circle /\
    forall a b, corner M v a b <-> In (a, b) (turns circle).
Proof.
  intros v w A B.
  assert (N : forall a b, corner M v a b -> exists c, corner M v b c).
  { intros a b H. apply corner_directed in H. destruct H as (_ & _ & H).
    apply directed_corner. apply (mesh_closed (b, v) H).
    intros E. apply border_edge in E. tauto. }
  assert (S : exists a b, corner M v a b).
  { destruct A as (x & [H|H]); eauto. }
  destruct S as (a0 & b0 & S).
  apply (circle node (corner M v) (map fst (directed M)) a0 b0).
  - repeat decide equality.
  - intros a b H. apply corner_directed in H. apply in_map_iff. exists (a, b). tauto.
  - intros a b b' H H'. eapply mesh_one_next; eauto.
  - intros a a' b H H'. eapply mesh_one_before; eauto.
  - exact N.
  - intros a b a' b' H H'. apply mesh_one_fan; [exists b|exists b']; auto.
  - exact S.
Qed.

(** ** In the border the neighbours of a vertex are a path *)

Lemma linked_back ts v w x : linked ts v w x ->
  clos_refl_sym_trans node (fun a b => corner ts v b a) w x.
Proof.
  induction 1 as [w x H| |w x _ IH|w x y _ IH _ IH'].
  - apply rst_sym, rst_step, H.
  - apply rst_refl.
  - apply rst_sym, IH.
  - eapply rst_trans; eauto.
Qed.

(** An edge in the border that has one triangle in its cell has one in the mesh. *)
Lemma border_segment c a x y : In c cells ->
  In (x, y) (directed (T (K c))) -> ~ In (y, x) (directed (T (K c))) ->
  ncoord a x = ncoord a y ->
  (ncoord a x = 0 /\ coord a c = 0) \/ (ncoord a x = 2 /\ coord a c + 1 = size nx ny nz a) ->
  ~ In (move c y, move c x) (directed M).
Proof.
  intros Hc H R E B H'. apply in_directed_mesh in H'.
  destruct H' as (c' & Hc' & p & q & H' & Ep & Eq).
  destruct (tile_local _ _ _ H) as (Lx & Ly & D). destruct (tile_local _ _ _ H') as (Lp & Lq & D').
  (* The other cell has both nodes, and is the same, or shares a face with them. *)
  destruct (two_nodes _ _ _ _ _ _ Ly Lx Lp Lq (not_eq_sym D) Ep Eq)
    as [<-|[(b & -> & Y & X & -> & ->)|(b & -> & Y & X & -> & ->)]].
  - apply move_injective in Ep. apply move_injective in Eq. subst. contradiction.
  - assert (b = a) by (apply (one_common_face x y b a); auto; destruct B; lia). subst b.
    destruct B as [[B _]|[_ B]]; [lia|].
    unfold cells in Hc'. rewrite in_box in Hc'. specialize (Hc' a).
    destruct a, c as [cx cy cz]; unfold up, set, coord in *; cbn [px py pz] in *; lia.
  - assert (b = a).
    { apply (one_common_face (nset b 0 q) (nset b 0 p) b a); auto; rewrite ?ncoord_nset; auto; [lia|].
      destruct B; lia. }
    subst b. rewrite ncoord_nset in B. destruct B as [[_ B]|[B _]]; [|lia].
    unfold cells in Hc'. rewrite in_box in Hc'. specialize (Hc' a).
    destruct a, c' as [cx cy cz]; unfold up, set, coord in *; cbn [px py pz] in *; lia.
Qed.

Theorem mesh_open_fan : forall v w, around M v w -> in_border nx ny nz v ->
  exists path, NoDup path /\ forall a b, corner M v a b <-> consecutive path a b.
Proof.
  intros v w A (x & B).
  pose proof A as A'. apply around_from_cell in A'. destruct A' as (c & Hc & v' & w' & A' & -> & _).
  (* The cell lies at the border, and has a segment there. *)
  assert (L : local v') by (eapply around_local; eauto).
  assert (S : (ncoord x v' = 0 /\ coord x c = 0) \/
              (ncoord x v' = 2 /\ coord x c + 1 = size nx ny nz x)).
  { rewrite ncoord_move in B. apply local_range in L.
    unfold cells in Hc. rewrite in_box in Hc. specialize (Hc x).
    assert (0 <= ncoord x v' <= 2) by (destruct x; tauto). lia. }
  assert (E : on_edge v') by (apply (local_on_edge v' x); [exact L|lia]).
  destruct (fan_ends _ _ _ C _ (possible_K c) v' w' E A' x) as (u & U & Q);
    [unfold even2; lia|].
  assert (F : forall a b, corner M (move c v') a b ->
    In a (map fst (directed M)) /\ In b (map fst (directed M))).
  { intros a b H. apply corner_directed in H. destruct H as (_ & H1 & H2).
    split; apply in_map_iff; [exists (a, b)|exists (b, move c v')]; auto. }
  destruct Q as [[Q R]|[Q R]].
  - (* The segment leaves the vertex: its end is the first neighbour. *)
    assert (R' : ~ In (move c u, move c v') (directed M)).
    { apply (border_segment c x v' u); auto. }
    assert (Q' : exists b, corner M (move c v') (move c u) b).
    { apply directed_corner, in_directed_mesh. exists c. split; [exact Hc|]. exists v', u. auto. }
    destruct (path node (fun a b => corner M (move c v') b a) (map fst (directed M)) (move c u))
      as (l & N & H).
    + intros b. destruct (in_directed_dec (move c v', b) (directed M)) as [D|D].
      * left. apply directed_corner, D.
      * right. intros a H. apply corner_directed in H. tauto.
    + intros a b H. apply F in H. tauto.
    + intros a b b' H H'. eapply mesh_one_before; eauto.
    + intros a a' b H H'. eapply mesh_one_next; eauto.
    + intros a b H. destruct Q' as [b' Q'].
      apply (linked_back M). apply mesh_one_fan; [exists b'; auto|exists b; auto].
    + intros b H. apply corner_directed in H. tauto.
    + exact Q'.
    + exists (rev l). split; [apply NoDup_rev, N|]. intros a b. split.
      * intros X. apply consecutive_rev, H, X.
      * intros X. apply H. rewrite <- (rev_involutive l). apply consecutive_rev, X.
  - (* The segment comes to the vertex: its start is the last neighbour. *)
    assert (R' : ~ In (move c v', move c u) (directed M)).
    { apply (border_segment c x u v'); auto. rewrite U. exact S. }
    assert (Q' : exists a, corner M (move c v') a (move c u)).
    { apply directed_corner_back, in_directed_mesh. exists c. split; [exact Hc|]. exists u, v'. auto. }
    apply (path node (corner M (move c v')) (map fst (directed M)) (move c u)).
    + intros b. destruct (in_directed_dec (b, move c v') (directed M)) as [D|D].
      * left. apply directed_corner_back, D.
      * right. intros a H. apply corner_directed in H. tauto.
    + exact F.
    + intros a b b' H H'. eapply mesh_one_next; eauto.
    + intros a a' b H H'. eapply mesh_one_before; eauto.
    + intros a b H. destruct Q' as [a' Q'].
      apply mesh_one_fan; [exists a'; auto|exists b; auto].
    + intros b H. apply corner_directed in H. tauto.
    + exact Q'.
Qed.

(** ** Vertices stand on crossed lattice edges, and the inside is on the right of segments *)

Theorem mesh_on_crossed_edges : forall c n, In c cells -> on_edge n ->
  ((exists w, around M (move c n) w) <-> crossed (K c) n = true).
Proof.
  intros c n Hc E. split.
  - intros (w & A). apply around_from_cell in A. destruct A as (c' & _ & n' & w' & A & En & _).
    assert (E' : on_edge n').
    { pose proof (around_local _ _ _ A) as L. destruct L as [L|L]; [exact L|exfalso].
      apply (edge_not_interior c c' n n'); assumption. }
    unfold K at 1. rewrite (crossed_same s d i c c' n n' E E' En).
    apply (nodes_crossed _ _ _ C _ (possible_K c') n' E'). exists w'. exact A.
  - intros H. apply (nodes_crossed _ _ _ C _ (possible_K c) n E) in H.
    destruct H as [w H]. exists (move c w). apply around_move; assumption.
Qed.

Theorem mesh_inside_behind : forall c e, In c cells -> In e (directed (T (K c))) ->
  ~ In (swap e) (directed (T (K c))) ->
  exists a side, even2 side /\ ncoord a (fst e) = side /\ ncoord a (snd e) = side /\
                 inside_on_the_right (K c) a side e.
Proof. intros c e _. apply (segments_on_faces _ _ _ C _ (possible_K c)). Qed.

End Mesh.

(** The local conditions suffice. *)
Theorem conditions_suffice : forall choices T I, conditions choices T I -> makes_surfaces choices T.
Proof.
  intros choices T I C s d i Hi nx ny nz. constructor.
  - eapply mesh_oriented; eauto.
  - eapply mesh_proper; eauto.
  - eapply mesh_closed; eauto.
  - eapply mesh_full_turn; eauto.
  - eapply mesh_open_fan; eauto.
  - eapply mesh_on_crossed_edges; eauto.
  - eapply mesh_inside_behind; eauto.
Qed.

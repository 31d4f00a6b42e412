(** * A finite relation in which each has one next and one before, linked and goes_on, is a circle *)

From Coq Require Import List Relations Lia.
From Proofs Require Import Lattice.
Import ListNotations.

Section Circle.

Variables (A : Type) (R : A -> A -> Prop) (V : list A) (a0 b0 : A).
Hypothesis dec : forall a b : A, {a = b} + {a <> b}.
Hypothesis finite : forall a b, R a b -> In a V.
Hypothesis next_one : forall a b b', R a b -> R a b' -> b = b'.
Hypothesis before_one : forall a a' b, R a b -> R a' b -> a = a'.
Hypothesis goes_on : forall a b, R a b -> exists c, R b c.
Hypothesis linked : forall a b a' b', R a b -> R a' b' -> clos_refl_sym_trans A R a a'.
Hypothesis start : R a0 b0.

(** A walk from [a] through the list, and where it ends. *)
Fixpoint walk (a : A) (l : list A) : Prop :=
  match l with [] => True | b :: m => R a b /\ walk b m end.
Fixpoint end_of (a : A) (l : list A) : A :=
  match l with [] => a | b :: m => end_of b m end.

Lemma walk_end l : forall a b, walk a l -> R (end_of a l) b -> walk a (l ++ [b]).
Proof. induction l as [|c l IH]; cbn; [auto|]. intros a b [H W] E. auto. Qed.

Lemma walk_split l : forall a b m, walk a (l ++ b :: m) -> R (end_of a l) b /\ walk b m.
Proof. induction l as [|c l IH]; cbn; [auto|]. intros a b m [_ W]. auto. Qed.

Lemma end_in l : forall a, In (end_of a l) (a :: l).
Proof. induction l as [|b l IH]; intros a; [left; reflexivity|]. right. apply IH. Qed.

Lemma end_app l : forall a b m, end_of a (l ++ b :: m) = end_of b m.
Proof. induction l as [|c l IH]; intros a b m; [reflexivity|]. apply IH. Qed.

Lemma end_goes_on l : forall a b, walk a l -> R a b -> exists c, R (end_of a l) c.
Proof.
  induction l as [|e l IH]; intros a b W H; [exists b; exact H|].
  destruct W as [W W']. destruct (goes_on _ _ W) as [c Hc]. apply (IH e c W' Hc).
Qed.

(** A walk without repetition goes on until it is back at its start. *)
Lemma comes_back n : forall l, NoDup (a0 :: l) -> walk a0 l -> length V < length (a0 :: l) + n ->
  exists m, NoDup (a0 :: m) /\ walk a0 m /\ R (end_of a0 m) a0.
Proof.
  induction n as [|n IH]; intros l N W L.
  - exfalso. assert (length (a0 :: l) <= length V); [|lia].
    apply NoDup_incl_length; [exact N|]. intros x [<-|X]; [eauto|].
    apply in_split in X. destruct X as (l1 & l2 & ->).
    apply walk_split in W. destruct W as [W _]. apply goes_on in W. destruct W as [c W]. eauto.
  - destruct (end_goes_on l a0 b0 W start) as [b E].
    destruct (in_dec dec b (a0 :: l)) as [[X|X]|X].
    + subst b. exists l. auto.
    + exfalso. apply in_split in X. destruct X as (l1 & l2 & ->).
      rewrite end_app in E. apply walk_split in W. destruct W as [W _].
      assert (Z : end_of a0 l1 = end_of b l2) by (eapply before_one; eauto).
      pose proof (end_in l1 a0) as Z1. pose proof (end_in l2 b) as Z2. rewrite Z in Z1.
      revert N Z1 Z2. generalize (end_of b l2). clear. intros z N Z1 Z2.
      change (NoDup ((a0 :: l1) ++ (b :: l2))) in N.
      induction (a0 :: l1) as [|x l IH]; [contradiction|].
      cbn in N. inversion N as [|? ? Nx Nl]; subst. destruct Z1 as [->|Z1].
      * apply Nx, in_or_app. auto.
      * apply IH; assumption.
    + apply (IH (l ++ [b])).
      * apply NoDup_cons_iff in N. destruct N as [Na N]. constructor.
        -- rewrite in_app_iff. intros [Y|[Y|[]]]; [contradiction|]. apply X. left. auto.
        -- apply NoDup_rev in N. rewrite <- (rev_involutive (l ++ [b])). apply NoDup_rev.
           rewrite rev_app_distr. cbn. constructor; [|exact N].
           rewrite <- in_rev. intros Y. apply X. right. exact Y.
      * apply walk_end; assumption.
      * cbn in *. rewrite app_length. cbn. lia.
Qed.

Lemma walk_pairs z : forall l a, walk a l -> R (end_of a l) z ->
  forall x y, In (x, y) (combine (a :: l) (l ++ [z])) -> R x y.
Proof.
  induction l as [|b l IH]; intros a W E x y H.
  - cbn in H. destruct H as [H|[]]. injection H. intros <- <-. exact E.
  - cbn [combine app] in H. destruct H as [H|H].
    + injection H. intros <- <-. apply W.
    + apply (IH b); [apply W|exact E|exact H].
Qed.

Lemma pair_from (l m : list A) x : length l = length m -> In x l -> exists y, In (x, y) (combine l m).
Proof.
  revert m. induction l as [|a l IH]; intros [|b m] E H; try discriminate; [contradiction|].
  destruct H as [->|H]; [exists b; left; reflexivity|].
  destruct (IH m) as [y Y]; [cbn in E; lia|exact H|]. exists y. right. exact Y.
Qed.

Lemma pair_to (l m : list A) y : length l = length m -> In y m -> exists x, In (x, y) (combine l m).
Proof.
  revert m. induction l as [|a l IH]; intros [|b m] E H; try discriminate; [contradiction|].
  destruct H as [->|H]; [exists a; left; reflexivity|].
  destruct (IH m) as [x X]; [cbn in E; lia|exact H|]. exists x. right. exact X.
Qed.

Theorem circle : exists l, NoDup l /\ forall a b, R a b <-> In (a, b) (turns l).
Proof.
  destruct (comes_back (length V) []) as (m & N & W & E).
  - constructor; [auto|constructor].
  - exact Logic.I.
  - cbn. lia.
  - exists (a0 :: m). split; [exact N|]. cbn [turns].
    assert (S : forall x y, In (x, y) (combine (a0 :: m) (m ++ [a0])) -> R x y).
    { intros x y. apply walk_pairs; assumption. }
    assert (L : length (a0 :: m) = length (m ++ [a0])) by (rewrite app_length; cbn; lia).
    assert (Q : forall x, In x (a0 :: m) <-> In x (m ++ [a0])).
    { intros x. rewrite in_app_iff. cbn. tauto. }
    assert (P1 : forall x y, R x y -> In x (a0 :: m) -> In (x, y) (combine (a0 :: m) (m ++ [a0]))).
    { intros x y H X. destruct (pair_from _ _ _ L X) as [y' Y].
      rewrite (next_one x y y' H (S _ _ Y)). exact Y. }
    assert (P2 : forall x y, R x y -> In y (a0 :: m) -> In x (a0 :: m)).
    { intros x y H Y. apply Q in Y. destruct (pair_to _ _ _ L Y) as [x' X].
      rewrite (before_one x x' y H (S _ _ X)). eapply in_combine_l; eauto. }
    assert (P3 : forall x y, R x y -> In x (a0 :: m) -> In y (a0 :: m)).
    { intros x y H X. apply Q. eapply in_combine_r. apply P1; eauto. }
    assert (P4 : forall x y, clos_refl_sym_trans A R x y -> (In x (a0 :: m) <-> In y (a0 :: m))).
    { induction 1 as [x y H| |x y _ IH|x y z _ IH _ IH'].
      - split; [apply P3|apply P2]; exact H.
      - tauto.
      - tauto.
      - tauto. }
    intros a b. split; [|apply S]. intros H. apply P1; [exact H|].
    apply (P4 a0 a); [eapply linked; eauto|left; reflexivity].
Qed.

End Circle.

(** ** A path, where one has no next *)

Lemma consecutive_rev A (l : list A) a b : consecutive l a b -> consecutive (rev l) b a.
Proof.
  intros (l1 & l2 & ->). exists (rev l2), (rev l1).
  rewrite rev_app_distr. cbn. rewrite <- !app_assoc. reflexivity.
Qed.

Section Path.

Variables (A : Type) (R : A -> A -> Prop) (V : list A) (z : A).
Hypothesis before : forall b, (exists a, R a b) \/ (forall a, ~ R a b).
Hypothesis finite : forall a b, R a b -> In a V /\ In b V.
Hypothesis next_one : forall a b b', R a b -> R a b' -> b = b'.
Hypothesis before_one : forall a a' b, R a b -> R a' b -> a = a'.
Hypothesis linked : forall a b, R a b -> clos_refl_sym_trans A R z a.
Hypothesis no_next : forall b, ~ R z b.
Hypothesis has_before : exists a, R a z.

(** Walk backwards from [z]. *)
Definition back (a b : A) : Prop := R b a.

Lemma comes_to_an_end n : forall l, NoDup (z :: l) -> walk A back z l ->
  (forall x, In x (z :: l) -> In x V) -> length V < length (z :: l) + n ->
  exists m, NoDup (z :: m) /\ walk A back z m /\ forall a, ~ R a (end_of A z m).
Proof.
  induction n as [|n IH]; intros l N W F L.
  - exfalso. assert (length (z :: l) <= length V); [|lia].
    apply NoDup_incl_length; [exact N|exact F].
  - destruct (before (end_of A z l)) as [[p E]|E]; [|exists l; auto].
    assert (X : ~ In p (z :: l)).
    { intros [X|X]; [subst p; eapply no_next; eauto|].
      apply in_split in X. destruct X as (l1 & l2 & ->).
      rewrite end_app in E. apply walk_split in W. destruct W as [W _].
      assert (Z : end_of A z l1 = end_of A p l2) by (eapply next_one; [exact W|exact E]).
      pose proof (end_in A l1 z) as Z1. pose proof (end_in A l2 p) as Z2. rewrite Z in Z1.
      revert N Z1 Z2. generalize (end_of A p l2). clear. intros y N Z1 Z2.
      change (NoDup ((z :: l1) ++ (p :: l2))) in N.
      induction (z :: l1) as [|x l IH]; [contradiction|].
      cbn in N. inversion N as [|? ? Nx Nl]; subst. destruct Z1 as [->|Z1].
      - apply Nx, in_or_app. auto.
      - apply IH; assumption. }
    apply (IH (l ++ [p])).
    + rewrite app_comm_cons. apply NoDup_rev in N. rewrite <- (rev_involutive ((z :: l) ++ [p])).
      apply NoDup_rev. rewrite rev_app_distr. cbn [rev app]. constructor; [|exact N].
      intros Y. apply X. apply in_rev. exact Y.
    + apply walk_end; [exact W|exact E].
    + rewrite app_comm_cons. intros x Y. apply in_app_or in Y. destruct Y as [Y|[<-|[]]]; [auto|].
      apply finite in E. apply E.
    + cbn in *. rewrite app_length. cbn. lia.
Qed.

Lemma consecutive_walk l : forall a x y, walk A back a l -> consecutive (a :: l) x y -> R y x.
Proof.
  intros a x y W (l1 & l2 & E). destruct l1 as [|b l1].
  - injection E. intros -> ->. apply W.
  - injection E. intros -> ->. clear E.
    change (x :: y :: l2) with ([x] ++ y :: l2) in W. rewrite app_assoc in W.
    apply walk_split in W. destruct W as [W _].
    rewrite end_app in W. exact W.
Qed.

Theorem path : exists l, NoDup l /\ forall a b, R a b <-> consecutive l a b.
Proof.
  destruct has_before as [a0 H0].
  destruct (comes_to_an_end (length V) []) as (m & N & W & E).
  - constructor; [auto|constructor].
  - exact Logic.I.
  - intros x [<-|[]]. apply finite in H0. apply H0.
  - cbn. lia.
  - exists (rev (z :: m)). split; [apply NoDup_rev, N|].
    assert (S : forall x y, consecutive (z :: m) y x -> R x y).
    { intros x y. apply consecutive_walk, W. }
    assert (P1 : forall x y, R x y -> In y (z :: m) -> consecutive (z :: m) y x).
    { intros x y H Y. apply in_split in Y. destruct Y as (l1 & l2 & Y).
      destruct l2 as [|x' l2].
      - exfalso. apply (E x). replace (end_of A z m) with y; [exact H|].
        destruct l1 as [|b l1]; injection Y; [intros -> ->; reflexivity|intros -> ->].
        symmetry. apply end_app.
      - assert (Q : consecutive (z :: m) y x') by (exists l1, l2; exact Y).
        rewrite (before_one x x' y H (S _ _ Q)). exact Q. }
    assert (P2 : forall x y, R x y -> In x (z :: m) -> In y (z :: m)).
    { intros x y H [X|X]; [subst x; exfalso; eapply no_next; eauto|].
      apply in_split in X. destruct X as (l1 & l2 & ->).
      apply walk_split in W. destruct W as [W _].
      rewrite (next_one x y (end_of A z l1) H W).
      pose proof (end_in A l1 z) as [X|X]; [left; exact X|right; apply in_or_app; auto]. }
    assert (P3 : forall x y, R x y -> In y (z :: m) -> In x (z :: m)).
    { intros x y H Y. destruct (P1 x y H Y) as (l1 & l2 & ->). apply in_or_app. cbn. auto. }
    assert (P4 : forall x y, clos_refl_sym_trans A R x y -> (In x (z :: m) <-> In y (z :: m))).
    { induction 1 as [x y H| |x y _ IH|x y w _ IH _ IH'].
      - split; [apply P2|apply P3]; exact H.
      - tauto.
      - tauto.
      - tauto. }
    intros a b. split.
    + intros H. apply consecutive_rev. apply P1; [exact H|].
      apply (P2 a b H). apply (P4 z a); [eapply linked; eauto|left; reflexivity].
    + intros H. apply S. rewrite <- (rev_involutive (z :: m)). apply consecutive_rev, H.
Qed.

End Path.

"""The errata of the thesis: what is printed, what is correct, and the figures of the gallery that they affect.

Each was found by rederiving the formula or by computing with both forms; docs/thesis.md names the files and tests of
the corrected forms.
"""

from dataclasses import dataclass


@dataclass(frozen=True)
class Erratum:
    """A misprint or mistake."""

    where: str  # equation, algorithm, table or section
    printed: str
    correct: str
    figures: tuple = ()  # names of figures of the gallery


# In the order of the thesis; their numbers start at 1.
ERRATA = (
    Erratum("Notation", "components j = 0 … d; the norm of u sums those of p", "j = 0 … d − 1; those of u"),
    Erratum(
        "Least squares of ch. 1, 3.1.2, Fig. 6.23",
        "B Bᵀ c = Bᵀ s",
        "Bᵀ B c = Bᵀ s with B of N rows (samples) and M columns; B Bᵀ is N × N and singular for M < N",
        ("figure-6.21",),
    ),
    Erratum(
        "Ch. 1, 8.1",
        "the basis spans a Haar space",
        "B needs full column rank; there is no Haar space in two and more dimensions",
    ),
    Erratum("1.2", "Shepard's method has m = 1", "m = 0: it reproduces constants"),
    Erratum(
        "(1.10)",
        "the union of the patches lies in Ω; the error is bounded by the largest local error of all patches",
        "Ω lies in the union; the patches that contain the point are enough",
        ("figure-1.1",),
    ),
    Erratum(
        "Table 2.1",
        "K_ν is a spherical Bessel function; inverse multiquadrics need β > d/2, compact ones l > ⌊d/2⌋ + 1",
        "K_ν is the modified Bessel function of the second kind; every β > 0; l ≥ ⌊d/2⌋ + 1",
        ("figure-2.1",),
    ),
    Erratum(
        "Def. 2.4, (2.10)",
        "order m: polynomials of degree m, with the dimension of those of degree m − 1",
        "polynomials of degree m − 1",
        ("figure-2.1",),
    ),
    Erratum("(2.6), (2.11)", "side conditions Σ αᵢ πⱼ = 0", "Σ αᵢ gⱼ(pᵢ) = 0: the polynomials, not their coefficients"),
    Erratum("(2.8), (2.13)", "[A Gᵀ; G 0] with G(i, j) = gⱼ(pᵢ)", "[A G; Gᵀ 0]"),
    Erratum(
        "Theorem 2.1, k = 2",
        "l² + 4l + 1",
        "l² + 4l + 3; with + 1 a term of r³ remains and the function has two continuous derivatives, not four",
        ("figure-2.1",),
    ),
    Erratum(
        "Table 2.3, d = 1, C⁴",
        "38r² + 5r + 1",
        "8r² + 5r + 1; with 38 the function is not positive definite",
        ("figure-2.1",),
    ),
    Erratum(
        "Table 2.3",
        "indices (l, k), where theorem 2.1 has (d, k); no C⁶ although the theorem gives it",
        "one convention; the rows k = 3",
        ("figure-2.1",),
    ),
    Erratum(
        "2.6.2.3, Fig. 2.4",
        "too small a support makes f discontinuous",
        "f stays as smooth as the kernel; it collapses to 0 between the samples",
        ("figure-2.4",),
    ),
    Erratum(
        "3.1.2, 3.2.4",
        "sums over j up to M − 1 of the previous level; the sum of squares is called a mean",
        "j < M of the level itself; it is a sum, so that λ grows with N",
        ("figure-3.4",),
    ),
    Erratum(
        "Algorithm 1, lines 5 to 12",
        "clusters are split where η < ε; the support is halved at the first level too; the errors are those of level 0",
        "split where η > ε; from the second level on; the errors of the level",
        ("figure-3.4", "figure-3.9"),
    ),
    Erratum(
        "Algorithm 1, support",
        "halved at every binary split",
        "times 2^(−1/d); halving leaves 66 % (d = 2) to 98 % (d = 3) of the samples outside of all supports",
        ("figure-3.1", "figure-3.4", "figure-3.9"),
    ),
    Erratum(
        "Algorithm 1, end",
        "clusters that have converged are not checked again",
        "later levels disturb them: all clusters have to be checked, and single samples need a last level of their own",
        ("figure-3.4", "figure-3.9"),
    ),
    Erratum("3.2.5", "25 % of the pixels", "30 %: 11,718 of 39,060", ("figure-3.14",)),
    Erratum(
        "(3.6), (6.19)",
        "σ = ρσ",
        "σ = ρ times the scale: the hat over the second σ is lost",
        ("figure-3.10", "figure-3.14", "figure-6.10"),
    ),
    Erratum(
        "(3.13)",
        "the smallest distance among the centres that are kept, which may be a single one",
        "among all farthest points of the level",
        ("figure-3.16",),
    ),
    Erratum(
        "(4.3)",
        "n and the principal directions are eigenvectors of ∇n",
        "of −PHP / ‖∇f‖ with P = I − nnᵀ; ∇n is not symmetric, and n is its left null vector only",
        ("figure-8.8",),
    ),
    Erratum("4.1.2", "H = ½ tr(−∇n)", "½ tr ∇n for the outward normal", ("figure-8.8",)),
    Erratum("(4.6)", "no factor ½", "half of it: a sphere of radius 2 has mean curvature ½", ("figure-8.8",)),
    Erratum(
        "4.1.3, valleys",
        "the derivative of the derivative of the smaller curvature is negative",
        "positive: a valley is a minimum of it",
        ("figure-6.4",),
    ),
    Erratum(
        "4.2",
        "union min, intersection max, difference max(f, −g)",
        "max, min and min(f, −g) with f > 0 inside",
    ),
    Erratum(
        "4.2, Ricci's blend",
        "tends to min and max for an exponent to 0; in the sign of f",
        "for an exponent to ∞; for F = exp(−f)",
    ),
    Erratum("4.2, linear blend", "−1 + Σ f", "1 − N + Σ f of N functions: the same for N = 2 only"),
    Erratum(
        "4.2, super-elliptic blend",
        "given as the union",
        "it is the intersection for f > 0 inside; the union is (Σ max(0, 1 + f)^β)^(1/β) − 1",
    ),
    Erratum(
        "(4.7)",
        "|f| / L is an upper bound of the distance; the step is f / L",
        "a lower bound, so the step |f| / L is safe",
    ),
    Erratum("(5.1), (5.2)", "f = T − Σ", "f = Σ − T for f > 0 inside", ("chapter-5",)),
    Erratum("5.4", "plane H = {p: ⟨n, r⟩ − D = 0}", "⟨n, p⟩ − D = 0", ("chapter-5",)),
    Erratum("(5.6)", "n·(p − a)", "n·(a − p) for f > 0 inside", ("chapter-5",)),
    Erratum(
        "6.1.2",
        "support R times the fill distance of the centres in the domain",
        "in the samples; that in the box is about 8 times as large for a sphere",
        ("figure-6.5", "figure-6.8"),
    ),
    Erratum(
        "(6.4), (6.24)",
        "the gradient is fitted to n",
        "to −n: f falls outwards",
        ("figure-6.5", "figure-6.17"),
    ),
    Erratum(
        "6.1.3, (6.25)",
        "the system said to minimise (6.4)",
        "it requires slopes of 1 with weights 1/w; min-max has 1/w² in the matrix and 1/w on the right",
        ("figure-6.17",),
    ),
    Erratum(
        "(6.4)-(6.6)",
        "monomials of absolute coordinates",
        "of local, scaled coordinates; else the fit changes when the object is moved or scaled",
        ("figure-6.5", "figure-6.17"),
    ),
    Erratum(
        "(6.10) ff.",
        "sums to 3(N − 1), Q without the index k, right side sⱼ",
        "0 … 3N − 1; BᵀW (s − g): the residual of the quadric",
        ("figure-6.8",),
    ),
    Erratum("(6.13)", "(d² − 1)² is C²", "C¹: the second derivative jumps by 8 at d = 1", ("figure-6.3",)),
    Erratum(
        "(6.14)",
        "the polynomial of degree 5 is C³",
        "C²; C³ needs 1 − 35d⁴ + 84d⁵ − 70d⁶ + 20d⁷",
        ("figure-6.3",),
    ),
    Erratum(
        "(6.15), C.2.2",
        "1 − 64 Π (p − S)(p − T) / …",
        "1 − Π 4(p − S)(T − p) / L², inside the box only; the printed form is 2 at the centre",
        ("figure-6.3",),
    ),
    Erratum(
        "Algorithm 4",
        "bounding boxes of overlapping sets of centres",
        "split without overlap, then grow the boxes; as printed copies multiply (88-fold for N = 10⁶) and holes stay",
        ("figure-1.1",),
    ),
    Erratum(
        "(6.33)-(6.35)",
        "B is M × N and BᵀB; the right side sums over j",
        "B is N × M; b_k = s_k − f(p_k) for α = 0",
        ("figure-6.21",),
    ),
    Erratum(
        "6.2.1.1",
        "the medial axis by the complement of the surface",
        "the points with two or more nearest points on the surface",
        ("figure-6.9",),
    ),
    Erratum("(7.1)", "Γ_t = ⟨V, n⟩", "⟨V, n⟩ n: a vector", ("figure-7.1",)),
    Erratum("7.2", "f on a space of dimension d + 1", "on R^d × R₊: space and time", ("figure-7.1",)),
    Erratum(
        "(7.13), (7.15), (7.16)",
        "f_t + V_n ‖∇f‖ = 0, ⟨n, ∇f⟩ = ‖∇f‖",
        "f_t = V_n ‖∇f‖ with f > 0 inside, where ⟨n, ∇f⟩ = −‖∇f‖",
        ("figure-7.1",),
    ),
    Erratum("(8.13)", "H μ′ = B", "H μ′ = −B, as (8.18) has it", ("figure-8.2",)),
    Erratum(
        "(8.20)-(8.24)",
        "‖B‖₁ ≤ max V / (π ε); ‖∇f‖ ≤ K′ ‖α‖₁",
        "N times the first; the second divided by σ",
        ("figure-8.4",),
    ),
    Erratum(
        "(8.31)",
        "V = −(I − C₁)² + (I − C₂)²",
        "the opposite sign for (7.11) and (8.18); as printed, all labels flip in every step",
        ("figure-8.2", "figure-8.6"),
    ),
    Erratum(
        "8.2.6, App. D",
        "β = σ in one, ε = 2σ = β in the other; a nonzero factor",
        "one of the two; a positive factor, since a negative one turns f inside out",
        ("figure-8.4",),
    ),
    Erratum(
        "App. A",
        "the derivative of the data term is + 2 Σ (s − f) exp(i p·u); the transform of f has Φ(−u)",
        "− 2 Σ (s − f) exp(−i p·u) and Φ(u); the result, αᵢ = (sᵢ − f(pᵢ)) / λ, is right",
    ),
    Erratum("App. B, Algorithm 6", "B, B₁", "Bᵢ, the box of the child"),
    Erratum(
        "C.1, Hessian",
        "2 ∇f ∇wᵀ and 2 ∇W ∇Sᵀ",
        "the symmetric parts: ∇f ∇wᵀ + ∇w ∇fᵀ, and so for the second",
    ),
    Erratum("C.2.1", "Hessian of d: (r I − ∇d ∇dᵀ) / (σ r³)", "(I − u uᵀ) / (σ r) with u = (p − c) / r"),
    Erratum("C.2.2", "mixed derivatives with one sign, the others with the opposite", "all of those of 1 − Π tᵣ"),
    Erratum(
        "App. D",
        "scaling to the l¹ ball brings points no farther apart, so the scheme converges",
        "it can move them apart by a factor of up to 2, and (8.28) also scales up: the proof does not hold",
        ("figure-8.4",),
    ),
)


def errata_of(name):
    """The errata that affect a figure of the gallery: a list of (number, Erratum)."""
    return [(i, erratum) for i, erratum in enumerate(ERRATA, 1) if name in erratum.figures]

"""The stages of the integrators, written by `lagc.render.stages` from `lagc.render.tableaus`."""

from __future__ import annotations

from math import sqrt

from lagc.render.numpy.support.base import FAILED, OK
from lagc.render.numpy.support.problem import Problem

# fmt: off
# -- what follows is part of generated modules --


def dopri5_stages(
    problem: Problem, t: float, x: list[float], h: float, k: list[list[float]], lam: list[float]
) -> tuple[int, list[float]]:
    rhs = problem.rhs
    y = [
        v + h * (0.2 * a0)
        for v, a0 in zip(x, k[0])
    ]
    status = rhs(t + 0.2 * h, y, k[1], lam)
    if status in FAILED:
        return status, y
    y = [
        v + h * (0.075 * a0 + 0.225 * a1)
        for v, a0, a1 in zip(x, k[0], k[1])
    ]
    status = rhs(t + 0.3 * h, y, k[2], lam)
    if status in FAILED:
        return status, y
    y = [
        v + h * (0.9777777777777777 * a0 - 3.7333333333333334 * a1 + 3.5555555555555554 * a2)
        for v, a0, a1, a2 in zip(x, k[0], k[1], k[2])
    ]
    status = rhs(t + 0.8 * h, y, k[3], lam)
    if status in FAILED:
        return status, y
    y = [
        v + h * (2.9525986892242035 * a0 - 11.595793324188385 * a1 + 9.822892851699436 * a2
            - 0.2908093278463649 * a3)
        for v, a0, a1, a2, a3 in zip(x, k[0], k[1], k[2], k[3])
    ]
    status = rhs(t + 0.8888888888888888 * h, y, k[4], lam)
    if status in FAILED:
        return status, y
    y = [
        v + h * (2.8462752525252526 * a0 - 10.757575757575758 * a1 + 8.906422717743473 * a2
            + 0.2784090909090909 * a3 - 0.2735313036020583 * a4)
        for v, a0, a1, a2, a3, a4 in zip(x, k[0], k[1], k[2], k[3], k[4])
    ]
    status = rhs(t + h, y, k[5], lam)
    if status in FAILED:
        return status, y
    y = [
        v + h * (0.09114583333333333 * a0 + 0.44923629829290207 * a2 + 0.6510416666666666 * a3
            - 0.322376179245283 * a4 + 0.13095238095238096 * a5)
        for v, a0, a2, a3, a4, a5 in zip(x, k[0], k[2], k[3], k[4], k[5])
    ]
    return OK, y


def dopri5_error(h: float, weights: list[float], k: list[list[float]]) -> float:
    sum0 = 0.0
    for weight, a0, a2, a3, a4, a5, a6 in zip(weights, k[0], k[2], k[3], k[4], k[5], k[6]):
        e = (0.0012326388888888888 * a0 - 0.0042527702905061394 * a2 + 0.03697916666666667 * a3
            - 0.05086379716981132 * a4 + 0.0419047619047619 * a5 - 0.025 * a6) / weight
        sum0 += e * e
    n = len(weights)
    h = abs(h)
    return h * sqrt(sum0 / n)


def dopri5_dense(
    problem: Problem, t: float, x: list[float], z: list[float], h: float,
    k: list[list[float]], lam: list[float],
) -> tuple[int, list[list[float]]]:
    r1 = [b - a for a, b in zip(x, z)]
    r2 = [h * a - b for a, b in zip(k[0], r1)]
    r3 = [a - h * b - c for a, b, c in zip(r1, k[6], r2)]
    r4 = [
        h * (-1.1270175653862835 * a0 + 2.675424484351598 * a2 - 5.685526961588504 * a3
            + 3.5219323679207912 * a4 - 1.7672812570757455 * a5 + 2.382468931778144 * a6)
        for a0, a2, a3, a4, a5, a6 in zip(k[0], k[2], k[3], k[4], k[5], k[6])
    ]
    return OK, [x, r1, r2, r3, r4]


def dopri5_at(s: float, r: list[list[float]]) -> list[float]:
    u = 1.0 - s
    return [
        r0 + s * (r1 + u * (r2 + s * (r3 + u * r4)))
        for r0, r1, r2, r3, r4 in zip(*r)
    ]


def dop853_stages(
    problem: Problem, t: float, x: list[float], h: float, k: list[list[float]], lam: list[float]
) -> tuple[int, list[float]]:
    rhs = problem.rhs
    y = [
        v + h * (0.05260015195876773 * a0)
        for v, a0 in zip(x, k[0])
    ]
    status = rhs(t + 0.05260015195876773 * h, y, k[1], lam)
    if status in FAILED:
        return status, y
    y = [
        v + h * (0.0197250569845379 * a0 + 0.0591751709536137 * a1)
        for v, a0, a1 in zip(x, k[0], k[1])
    ]
    status = rhs(t + 0.0789002279381516 * h, y, k[2], lam)
    if status in FAILED:
        return status, y
    y = [
        v + h * (0.02958758547680685 * a0 + 0.08876275643042054 * a2)
        for v, a0, a2 in zip(x, k[0], k[2])
    ]
    status = rhs(t + 0.1183503419072274 * h, y, k[3], lam)
    if status in FAILED:
        return status, y
    y = [
        v + h * (0.2413651341592667 * a0 - 0.8845494793282861 * a2 + 0.924834003261792 * a3)
        for v, a0, a2, a3 in zip(x, k[0], k[2], k[3])
    ]
    status = rhs(t + 0.2816496580927726 * h, y, k[4], lam)
    if status in FAILED:
        return status, y
    y = [
        v + h * (0.037037037037037035 * a0 + 0.17082860872947386 * a3 + 0.12546768756682242 * a4)
        for v, a0, a3, a4 in zip(x, k[0], k[3], k[4])
    ]
    status = rhs(t + 0.3333333333333333 * h, y, k[5], lam)
    if status in FAILED:
        return status, y
    y = [
        v + h * (0.037109375 * a0 + 0.17025221101954405 * a3 + 0.06021653898045596 * a4
            - 0.017578125 * a5)
        for v, a0, a3, a4, a5 in zip(x, k[0], k[3], k[4], k[5])
    ]
    status = rhs(t + 0.25 * h, y, k[6], lam)
    if status in FAILED:
        return status, y
    y = [
        v + h * (0.03709200011850479 * a0 + 0.17038392571223998 * a3 + 0.10726203044637328 * a4
            - 0.015319437748624402 * a5 + 0.008273789163814023 * a6)
        for v, a0, a3, a4, a5, a6 in zip(x, k[0], k[3], k[4], k[5], k[6])
    ]
    status = rhs(t + 0.3076923076923077 * h, y, k[7], lam)
    if status in FAILED:
        return status, y
    y = [
        v + h * (0.6241109587160757 * a0 - 3.3608926294469414 * a3 - 0.868219346841726 * a4
            + 27.59209969944671 * a5 + 20.154067550477894 * a6 - 43.48988418106996 * a7)
        for v, a0, a3, a4, a5, a6, a7 in zip(x, k[0], k[3], k[4], k[5], k[6], k[7])
    ]
    status = rhs(t + 0.6512820512820513 * h, y, k[8], lam)
    if status in FAILED:
        return status, y
    y = [
        v + h * (0.47766253643826434 * a0 - 2.4881146199716677 * a3 - 0.590290826836843 * a4
            + 21.230051448181193 * a5 + 15.279233632882423 * a6 - 33.28821096898486 * a7
            - 0.020331201708508627 * a8)
        for v, a0, a3, a4, a5, a6, a7, a8 in zip(x, k[0], k[3], k[4], k[5], k[6], k[7], k[8])
    ]
    status = rhs(t + 0.6 * h, y, k[9], lam)
    if status in FAILED:
        return status, y
    y = [
        v + h * (-0.9371424300859873 * a0 + 5.186372428844064 * a3 + 1.0914373489967295 * a4
            - 8.149787010746927 * a5 - 18.52006565999696 * a6 + 22.739487099350505 * a7
            + 2.4936055526796523 * a8 - 3.0467644718982196 * a9)
        for v, a0, a3, a4, a5, a6, a7, a8, a9 in zip(x, k[0], k[3], k[4], k[5],
            k[6], k[7], k[8], k[9])
    ]
    status = rhs(t + 0.8571428571428571 * h, y, k[10], lam)
    if status in FAILED:
        return status, y
    y = [
        v + h * (2.273310147516538 * a0 - 10.53449546673725 * a3 - 2.0008720582248625 * a4
            - 17.9589318631188 * a5 + 27.94888452941996 * a6 - 2.8589982771350235 * a7
            - 8.87285693353063 * a8 + 12.360567175794303 * a9 + 0.6433927460157636 * a10)
        for v, a0, a3, a4, a5, a6, a7, a8, a9, a10 in zip(x, k[0], k[3], k[4], k[5],
            k[6], k[7], k[8], k[9], k[10])
    ]
    status = rhs(t + h, y, k[11], lam)
    if status in FAILED:
        return status, y
    y = [
        v + h * (0.054293734116568765 * a0 + 4.450312892752409 * a5 + 1.8915178993145003 * a6
            - 5.801203960010585 * a7 + 0.3111643669578199 * a8 - 0.1521609496625161 * a9
            + 0.20136540080403034 * a10 + 0.04471061572777259 * a11)
        for v, a0, a5, a6, a7, a8, a9, a10, a11 in zip(x, k[0], k[5], k[6], k[7],
            k[8], k[9], k[10], k[11])
    ]
    return OK, y


def dop853_error(h: float, weights: list[float], k: list[list[float]]) -> float:
    sum0 = 0.0
    sum1 = 0.0
    for weight, a0, a5, a6, a7, a8, a9, a10, a11 in zip(weights, k[0], k[5], k[6], k[7],
            k[8], k[9], k[10], k[11]):
        e = (0.01312004499419488 * a0 - 1.2251564463762044 * a5 - 0.4957589496572502 * a6
            + 1.6643771824549864 * a7 - 0.35032884874997366 * a8
            + 0.3341791187130175 * a9 + 0.08192320648511571 * a10
            - 0.022355307863886294 * a11) / weight
        sum0 += e * e
        e = (-0.18980075407240762 * a0 + 4.450312892752409 * a5 + 1.8915178993145003 * a6
            - 5.801203960010585 * a7 - 0.42268232132379197 * a8
            - 0.1521609496625161 * a9 + 0.20136540080403034 * a10
            + 0.022651792198360825 * a11) / weight
        sum1 += e * e
    n = len(weights)
    h = abs(h)
    total = sum0 + 0.01 * sum1
    if total == 0.0:
        return 0.0
    return h * sum0 * sqrt(1.0 / (n * total))


def dop853_parts(k: list[list[float]]) -> list[list[float]]:
    return [
        [
            0.01312004499419488 * a0 - 1.2251564463762044 * a5 - 0.4957589496572502 * a6
                + 1.6643771824549864 * a7 - 0.35032884874997366 * a8
                + 0.3341791187130175 * a9 + 0.08192320648511571 * a10
                - 0.022355307863886294 * a11
            for a0, a5, a6, a7, a8, a9, a10, a11 in zip(k[0], k[5], k[6], k[7],
            k[8], k[9], k[10], k[11])
        ],
        [
            -0.18980075407240762 * a0 + 4.450312892752409 * a5 + 1.8915178993145003 * a6
                - 5.801203960010585 * a7 - 0.42268232132379197 * a8
                - 0.1521609496625161 * a9 + 0.20136540080403034 * a10
                + 0.022651792198360825 * a11
            for a0, a5, a6, a7, a8, a9, a10, a11 in zip(k[0], k[5], k[6], k[7],
            k[8], k[9], k[10], k[11])
        ],
    ]


def dop853_dense(
    problem: Problem, t: float, x: list[float], z: list[float], h: float,
    k: list[list[float]], lam: list[float],
) -> tuple[int, list[list[float]]]:
    rhs = problem.rhs
    y = [
        v + h * (0.056167502283047954 * a0 + 0.25350021021662483 * a6 - 0.2462390374708025 * a7
            - 0.12419142326381637 * a8 + 0.15329179827876568 * a9
            + 0.00820105229563469 * a10 + 0.007567897660545699 * a11 - 0.008298 * a12)
        for v, a0, a6, a7, a8, a9, a10, a11, a12 in zip(x, k[0], k[6], k[7], k[8],
            k[9], k[10], k[11], k[12])
    ]
    status = rhs(t + 0.1 * h, y, k[13], lam)
    if status in FAILED:
        return status, []
    y = [
        v + h * (0.03183464816350214 * a0 + 0.028300909672366776 * a5 + 0.053541988307438566 * a6
            - 0.05492374857139099 * a7 - 0.00010834732869724932 * a10
            + 0.0003825710908356584 * a11 - 0.00034046500868740456 * a12
            + 0.1413124436746325 * a13)
        for v, a0, a5, a6, a7, a10, a11, a12, a13 in zip(x, k[0], k[5], k[6], k[7],
            k[10], k[11], k[12], k[13])
    ]
    status = rhs(t + 0.2 * h, y, k[14], lam)
    if status in FAILED:
        return status, []
    y = [
        v + h * (-0.42889630158379194 * a0 - 4.697621415361164 * a5 + 7.683421196062599 * a6
            + 4.06898981839711 * a7 + 0.3567271874552811 * a8
            - 0.0013990241651590145 * a12 + 2.9475147891527724 * a13
            - 9.15095847217987 * a14)
        for v, a0, a5, a6, a7, a8, a12, a13, a14 in zip(x, k[0], k[5], k[6], k[7],
            k[8], k[12], k[13], k[14])
    ]
    status = rhs(t + 0.7777777777777778 * h, y, k[15], lam)
    if status in FAILED:
        return status, []
    r1 = [b - a for a, b in zip(x, z)]
    r2 = [h * a - b for a, b in zip(k[0], r1)]
    r3 = [a - h * b - c for a, b, c in zip(r1, k[12], r2)]
    r4 = [
        h * (-8.428938276109013 * a0 + 0.5667149535193777 * a5 - 3.0689499459498917 * a6
            + 2.38466765651207 * a7 + 2.117034582445028 * a8 - 0.871391583777973 * a9
            + 2.2404374302607883 * a10 + 0.6315787787694688 * a11
            - 0.08899033645133331 * a12 + 18.148505520854727 * a13
            - 9.194632392478356 * a14 - 4.436036387594894 * a15)
        for a0, a5, a6, a7, a8, a9, a10, a11, a12, a13, a14, a15 in zip(k[0], k[5], k[6], k[7], k[8], k[9],
            k[10], k[11], k[12], k[13], k[14], k[15])
    ]
    r5 = [
        h * (10.427508642579134 * a0 + 242.28349177525817 * a5 + 165.20045171727028 * a6
            - 374.5467547226902 * a7 - 22.113666853125306 * a8 + 7.733432668472264 * a9
            - 30.674084731089398 * a10 - 9.332130526430229 * a11
            + 15.697238121770845 * a12 - 31.139403219565178 * a13
            - 9.35292435884448 * a14 + 35.81684148639408 * a15)
        for a0, a5, a6, a7, a8, a9, a10, a11, a12, a13, a14, a15 in zip(k[0], k[5], k[6], k[7], k[8], k[9],
            k[10], k[11], k[12], k[13], k[14], k[15])
    ]
    r6 = [
        h * (19.985053242002433 * a0 - 387.0373087493518 * a5 - 189.17813819516758 * a6
            + 527.8081592054236 * a7 - 11.57390253995963 * a8 + 6.8812326946963 * a9
            - 1.0006050966910838 * a10 + 0.7777137798053443 * a11
            - 2.778205752353508 * a12 - 60.19669523126412 * a13
            + 84.32040550667716 * a14 + 11.99229113618279 * a15)
        for a0, a5, a6, a7, a8, a9, a10, a11, a12, a13, a14, a15 in zip(k[0], k[5], k[6], k[7], k[8], k[9],
            k[10], k[11], k[12], k[13], k[14], k[15])
    ]
    r7 = [
        h * (-25.69393346270375 * a0 - 154.18974869023643 * a5 - 231.5293791760455 * a6
            + 357.6391179106141 * a7 + 93.40532418362432 * a8 - 37.45832313645163 * a9
            + 104.0996495089623 * a10 + 29.8402934266605 * a11 - 43.53345659001114 * a12
            + 96.32455395918828 * a13 - 39.17726167561544 * a14
            - 149.72683625798564 * a15)
        for a0, a5, a6, a7, a8, a9, a10, a11, a12, a13, a14, a15 in zip(k[0], k[5], k[6], k[7], k[8], k[9],
            k[10], k[11], k[12], k[13], k[14], k[15])
    ]
    return OK, [x, r1, r2, r3, r4, r5, r6, r7]


def dop853_at(s: float, r: list[list[float]]) -> list[float]:
    u = 1.0 - s
    return [
        r0 + s * (r1 + u * (r2 + s * (r3 + u * (r4 + s * (r5 + u * (r6 + s * r7))))))
        for r0, r1, r2, r3, r4, r5, r6, r7 in zip(*r)
    ]

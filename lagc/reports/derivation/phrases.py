"""The sentences of a solution, one row each: a key, then English, French and German.

`{}` is a place for a formula, a name or a number. Sentences avoid agreement with numbers.
"""

LANGUAGES = ("en", "fr", "de")

_TABLE = """
scene | Scene {}. | Scène {}. | Szene {}.
scene_effects | Scene {}, with {}. | Scène {}, avec {}. | Szene {}, mit {}.
notation | A star marks what is virtual. K is the kinetic energy, U the force function (V = -U), {} given forces, {} forces of constraints. | L'étoile marque ce qui est virtuel. K est l'énergie cinétique, U la fonction de force (V = -U), {} les actions données, {} les actions de liaison. | Der Stern kennzeichnet Virtuelles. K ist die kinetische Energie, U die Kräftefunktion (V = -U), {} eingeprägte Kräfte, {} Zwangskräfte.
h_parameters | Parameters | Paramétrage | Parameter
h_constraints | Explicit constraints | Liaisons explicites | Explizite Bindungen
h_kinematics | Kinematics | Cinématique | Kinematik
h_kinetic | Kinetic energy | Énergie cinétique | Kinetische Energie
h_virtual | Virtual velocities | Vitesses virtuelles | Virtuelle Geschwindigkeiten
h_actions | Given actions | Actions données | Eingeprägte Kräfte
h_forces | Forces of constraints | Actions de liaison | Zwangskräfte
h_count | Count | Décompte | Abzählung
h_lagrange | Lagrange's equations | Équations de Lagrange | Lagrange-Gleichungen
h_result | Result | Résultat | Ergebnis
h_lagrangian | With L = K + U | Avec L = K + U | Mit L = K + U
h_conserved | Conserved | Intégrales premières | Erhaltungsgrößen
h_reactions | Reactions | Réactions | Reaktionen
h_motion | Motion | Mouvement | Bewegung
parameter | parameter | paramètre | Parameter
meaning | meaning | signification | Bedeutung
unit | unit | unité | Einheit
value | value | valeur | Wert
start | At t = 0: | À t = 0 : | Bei t = 0:
orientation | unit quaternion; its rates are {}, the components of the rotation vector in the axes of the body | quaternion unitaire ; ses vitesses sont {}, les composantes du vecteur rotation dans les axes du solide | Einheitsquaternion; seine Geschwindigkeiten sind {}, die Komponenten der Winkelgeschwindigkeit in den Achsen des Körpers
speeds | The speeds are declared: | Les vitesses sont déclarées : | Die Geschwindigkeiten sind erklärt:
rates_of_speeds | Solved for the rates: | D'où les dérivées : | Nach den Ableitungen aufgelöst:
free_count | Free, the system would have {} parameters ({}). It has {}. Implicit constraints: {}. | Libre, le système aurait {} paramètres ({}). Il en a {}. Liaisons implicites : {}. | Frei hätte das System {} Parameter ({}). Es hat {}. Implizite Bindungen: {}.
free_all | Free, the system has {} parameters ({}): all are kept, no constraint is implicit. | Libre, le système a {} paramètres ({}) : tous sont gardés, aucune liaison n'est implicite. | Frei hat das System {} Parameter ({}): alle bleiben, keine Bindung ist implizit.
free_more | The bodies alone would have {} parameters ({}). The system has {}. | Les corps seuls auraient {} paramètres ({}). Le système en a {}. | Die Körper allein hätten {} Parameter ({}). Das System hat {}.
particle_3 | {}: particle, 3 | {} : point, 3 | {}: Punkt, 3
solid_6 | {}: solid, 6 | {} : solide, 6 | {}: starrer Körper, 6
turns_about | {} turns about {} only | {} ne tourne qu'autour de {} | {} dreht nur um {}
does_not_turn | {} does not turn | {} ne tourne pas | {} dreht nicht
pivot | {}: pivot of {} and {} | {} : pivot de {} et {} | {}: Drehgelenk von {} und {}
ball | {}: ball joint of {} and {} | {} : rotule de {} et {} | {}: Kugelgelenk von {} und {}
universal | {}: universal joint of {} and {} | {} : cardan de {} et {} | {}: Kardangelenk von {} und {}
ground | the ground | le bâti | dem Boden
none_explicit | None. | Aucune. | Keine.
holonomic | holonomic | holonome | holonom
integrable | holonomic once integrated | holonome après intégration | nach Integration holonom
nonholonomic | not holonomic | non holonome | nicht holonom
velocity_row | on velocities, not examined for integrability | sur les vitesses, intégrabilité non examinée | für Geschwindigkeiten, Integrierbarkeit nicht geprüft
rheonomic | moved by time | dépend du temps | zeitabhängig
scleronomic | not moved by time | indépendante du temps | zeitunabhängig
exterior | exterior | extérieure | äußere
interior | interior | intérieure | innere
one_sided | one-sided, {} | unilatérale, {} | einseitig, {}
always_closed | a constraint with friction, always closed | une liaison avec frottement, toujours fermée | eine Bindung mit Reibung, immer geschlossen
with_friction | with friction | avec frottement | mit Reibung
without_friction | without friction | sans frottement | ohne Reibung
its_rate | Its rate has the form {}: | Sa dérivée a la forme {} : | Ihre Ableitung hat die Form {}:
slip | The slip is | Le glissement est | Der Schlupf ist
bases | Unit vectors: | Vecteurs unitaires : | Einheitsvektoren:
positions | Positions: | Positions : | Lagen:
velocities | Velocities: | Vitesses : | Geschwindigkeiten:
accelerations | Accelerations: | Accélérations : | Beschleunigungen:
rotations | Rotation vectors: | Vecteurs rotation : | Winkelgeschwindigkeiten:
in_total | In total, | Au total, | Insgesamt
degrees | By degree in the rates, {}: | Par degré en les vitesses, {} : | Nach dem Grad in den Geschwindigkeiten, {}:
no_mass | No body has a mass. | Aucun corps n'a de masse. | Kein Körper hat Masse.
drives_stay | Motion that time alone brings, at fixed parameters, is no part of a virtual velocity. | Le mouvement dû au seul temps n'entre pas dans une vitesse virtuelle. | Bewegung durch die Zeit allein gehört nicht zur virtuellen Geschwindigkeit.
compatible | Compatible with the constraints are those with | Sont compatibles avec les liaisons celles où | Mit den Bindungen verträglich sind die mit
torsor | {}, at {}: | {}, en {} : | {}, in {}:
couple | {}, a couple on {}: | {}, un couple sur {} : | {}, ein Moment an {}:
weight | {}: the weights, | {} : les poids, | {}: die Gewichte,
has_function | It derives from | Elle dérive de | Sie stammt aus
potential | {} derives from | {} dérive de | {} stammt aus
dissipation | {} derives from the dissipation function | {} dérive de la fonction de dissipation | {} stammt aus der Dissipationsfunktion
kinetic_term | {} is a term of K. | {} est un terme de K. | {} ist ein Glied von K.
free_term | {} is a term of the Lagrangian with rates. It acts with {}: | {} est un terme du lagrangien avec vitesses. Il agit par {} : | {} ist ein Glied der Lagrange-Funktion mit Geschwindigkeiten. Es wirkt mit {}:
no_actions | No action is given. | Aucune action donnée. | Keine Kraft ist eingeprägt.
implicit_perfect | The implicit constraints are perfect: {}. | Les liaisons implicites sont parfaites : {}. | Die impliziten Bindungen sind ideal: {}.
explicit_perfect | {} is perfect, with the multiplier {}: | {} est parfaite, de multiplicateur {} : | {} ist ideal, mit dem Multiplikator {}:
explicit_table | The explicit ones are perfect: {}, with | Les explicites sont parfaites : {}, avec | Die expliziten sind ideal: {}, mit
servo | {} is held by {}, which does work: its force is not along the gradient. | {} est tenue par {}, qui travaille : sa force n'est pas le long du gradient. | {} wird von {} gehalten, das Arbeit leistet: seine Kraft liegt nicht im Gradienten.
contact_push | {} pushes with {} along its gap: | {} pousse avec {} : | {} drückt mit {}:
contact_rubs | It rubs with {} along its slip (imperfect): | Elle frotte avec {} (liaison imparfaite) : | Sie reibt mit {} (nicht ideal):
friction | friction | frottement | Reibung
law_of | Law by mode: | Loi selon le mode : | Gesetz je nach Zustand:
mode_column | mode | mode | Zustand
law_column | law | loi | Gesetz
open | open | ouvert | offen
closed | touches | en contact | geschlossen
sticks | sticks | adhère | haftet
slips | slips | glisse | gleitet
and | and | et | und
all_contacts | with the forces of all contacts | avec les actions de tous les contacts | mit den Kräften aller Kontakte
count_line | as many unknowns (second derivatives, multipliers) as equations (of Lagrange, of constraints). | autant d'inconnues (dérivées secondes, multiplicateurs) que d'équations (de Lagrange, de liaison). | so viele Unbekannte (zweite Ableitungen, Multiplikatoren) wie Gleichungen (Lagrange, Bindungen).
dof | Degrees of freedom: {}. | Degrés de liberté : {}. | Freiheitsgrade: {}.
equation_of | Parameter {} | Paramètre {} | Parameter {}
rotation_of | Rotation {} | Rotation {} | Drehung {}
along_speeds | In the directions of the speeds: each equation times the derivative of its rate by a speed, added. | Dans les directions des vitesses : chaque équation multipliée par la dérivée de sa vitesse, puis sommées. | In den Richtungen der Geschwindigkeiten: jede Gleichung mal der Ableitung ihrer Geschwindigkeit, addiert.
divided_by | divided by | divisé par | geteilt durch
times_by | times | multiplié par | mal
mode | Mode: {} | Mode : {} | Zustand: {}
impact | At an impact: | Au choc : | Beim Stoß:
event | At events: | Aux événements : | Bei Ereignissen:
where_short | {} stands for {} | {} désigne {} | {} steht für {}
all_derive | All actions derive from U and no explicit constraint is left: | Toutes les actions dérivent de U, et il ne reste pas de liaison explicite : | Alle Kräfte stammen aus U, und keine explizite Bindung bleibt:
same | the same equations. | les mêmes équations. | dieselben Gleichungen.
not_lagrangian | Not applicable: {}. | Sans objet : {}. | Entfällt: {}.
because_row | {} is explicit | {} est explicite | {} ist explizit
because_action | {} has no U | {} n'a pas de U | {} hat kein U
nothing | Nothing was found. | Rien n'a été trouvé. | Nichts gefunden.
conserved_line | {}, since {} | {}, car {} | {}, denn {}
since_energy | nothing brings power or takes it | rien n'apporte ni ne prend de puissance | nichts führt Leistung zu oder ab
since_jacobi | only drives bring power (Jacobi's integral, not the energy) | seuls les entraînements apportent de la puissance (intégrale de Jacobi) | nur Antriebe führen Leistung zu (Jacobi-Integral, nicht die Energie)
since_cyclic | {} is cyclic and no force acts along it | {} est cyclique et rien n'agit suivant lui | {} ist zyklisch und keine Kraft wirkt längs davon
since_momentum | no net force acts along it | aucune résultante n'agit suivant cet axe | keine Gesamtkraft wirkt längs davon
since_angular_momentum | no net torque acts about it | aucun moment résultant n'agit autour de cet axe | kein Gesamtmoment wirkt um diese Achse
seems | (it seems, from the states tried) | (d'après les états essayés) | (nach den versuchten Zuständen)
while_open | while contacts are open | tant que les contacts sont ouverts | solange Kontakte offen sind
without_rubbing | without friction | sans frottement | ohne Reibung
between_events | between events | entre les événements | zwischen Ereignissen
between_cuts | up to full turns of an angle | à des tours complets près | bis auf volle Umläufe eines Winkels
reaction_solved | With the equations solved for the multipliers: | En résolvant pour les multiplicateurs : | Nach den Multiplikatoren aufgelöst:
parts | an expression of {} parts | une expression de {} parties | ein Ausdruck aus {} Teilen
more_terms | {} more terms | encore {} termes | noch {} Glieder
abbreviated | Abbreviated formulas: {}. The option --full writes all terms. | Formules abrégées : {}. L'option --full écrit tous les termes. | Gekürzte Formeln: {}. Die Option --full schreibt alle Glieder.
values | With the values | Avec les valeurs | Mit den Werten
simulated | the motion from t = 0 to {}: | le mouvement de t = 0 à {} : | die Bewegung von t = 0 bis {}:
error | Estimated relative error: {}. | Erreur relative estimée : {}. | Geschätzter relativer Fehler: {}.
stopped | The run stopped at t = {}: {} | Le calcul s'est arrêté à t = {} : {} | Die Rechnung hielt bei t = {}: {}
"""  # noqa: E501


class Phrases:
    """The sentences in one language: `say("dof", 2)`."""

    def __init__(self, language: str):
        """Raise ValueError for a language that is not in `LANGUAGES`."""
        column = 1 + LANGUAGES.index(language)
        rows = [line.split(" | ") for line in _TABLE.strip().splitlines()]
        self._rows = {row[0]: row[column].strip() for row in rows}

    def __call__(self, key: str, *given: object) -> str:
        """Return the sentence with `given` in its places."""
        return self._rows[key].format(*given)

    def all_of(self, *keys: str) -> str:
        """Return several words with "and" between them."""
        return f" {self('and')} ".join(map(self, keys))

"""A repair of somebody else's, in one file: masses in grams."""

from drake_twin.description.repairs import repair


@repair("mass_in_grams")
def mass_in_grams(reader):
    """Take a mass of more than a ton for one in grams."""
    for mass in reader.root.iterfind("link/inertial/mass"):
        grams = float(mass.get("value"))
        if grams > 1000:
            mass.set("value", str(grams / 1000))
            yield mass, f"a mass of {grams:g} kg is taken for grams"

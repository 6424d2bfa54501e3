"""Message packages made up for tests."""


def write_package(folder, name, **files):
    """Write a package of interface files (``msg={"A": "int32 a"}``, ``srv=``, ``action=``); return its folder."""
    package = folder / name
    package.mkdir(parents=True, exist_ok=True)
    (package / "package.xml").write_text(f"<package><name>{name}</name></package>\n")
    for kind, texts in files.items():
        (package / kind).mkdir(exist_ok=True)
        for own, text in texts.items():
            (package / kind / f"{own}.{kind}").write_text(text)
    return package


def folder_of(*packages):
    """Return a function that finds these packages by name."""
    return {package.name: package for package in packages}.get

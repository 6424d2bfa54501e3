def expose_action(name):
    return lambda cls: cls


def expose_substitution(name):
    return lambda cls: cls

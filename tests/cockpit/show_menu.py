"""The menu of what is shown, as tests operate it."""


def switch(tab, label):
    """The switch of what is shown by its label; the menu is open then."""
    if tab.locator("#show-menu").is_hidden():
        tab.locator("#show-button").click(force=True)
    return tab.locator("#show-menu").get_by_label(label, exact=True)


def close(tab):
    """Close the menu."""
    if tab.locator("#show-menu").is_visible():
        tab.locator("#show-menu").get_by_role("button", name="Close").click(force=True)


def press(tab, label):
    """Operate a switch, and close the menu."""
    switch(tab, label).click(force=True)
    close(tab)

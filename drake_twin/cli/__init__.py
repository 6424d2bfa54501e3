"""What the command line programs share: options, target, summary, plot."""
